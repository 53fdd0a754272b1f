#pragma once

#include <filesystem>
#include <string>

#include "asset/case.h"

namespace clipgs {

/// Today, or the day of SOURCE_DATE_EPOCH for builds that must repeat to the byte: ISO 8601.
std::string today();

/// Gives a case that is made now its title (empty: the usual one of its look) and its date.
void name_case(Case& contents, const std::string& title);

/// Whether there is a case in which all is trained that it is to have. One that is not is written
/// over as soon as there is a better one.
bool is_finished_case(const std::filesystem::path& path);

/// Writes the case with its thumbnail, and says in a line what it holds, takes, and costs to draw.
/// Throws Error.
void write_finished_case(const std::filesystem::path& path, const Case& contents,
                         const CaseCoding& coding);

}  // namespace clipgs
