#pragma once

#include <span>
#include <string>

#include "cli/described.h"

namespace clipgs {

/// The manual page (section 1, roff with man(7)'s macros) of the program: what its commands are.
std::string program_page(const DescribedCommand& program,
                         std::span<const DescribedCommand> commands);

/// The manual page of one of its commands.
std::string command_page(const DescribedCommand& program, const DescribedCommand& command);

}  // namespace clipgs
