#pragma once

#include <filesystem>

#include "asset/case.h"

namespace clipgs {

/// Writes the case with its thumbnail, and says in a line what it holds, takes, and costs to draw.
/// Throws Error.
void write_finished_case(const std::filesystem::path& path, const Case& contents,
                         const CaseCoding& coding);

}  // namespace clipgs
