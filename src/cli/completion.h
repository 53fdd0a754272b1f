#pragma once

#include <span>
#include <string>

#include "cli/described.h"

namespace clipgs {

/// What completes the program's command line by Tab in a shell; files where nothing else is known.
std::string bash_completion(const DescribedCommand& program,
                            std::span<const DescribedCommand> commands);
std::string zsh_completion(const DescribedCommand& program,
                           std::span<const DescribedCommand> commands);
std::string fish_completion(const DescribedCommand& program,
                            std::span<const DescribedCommand> commands);

}  // namespace clipgs
