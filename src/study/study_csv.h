#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "study/study_table.h"

namespace clipgs {

/// Bytes of the largest table that is read.
inline constexpr std::uintmax_t kMostCsvBytes = std::uintmax_t{16} << 20;

/// Reads a table with a row for each participant and mode (docs/study_analysis.md). Columns, in any
/// order: participant, mode; q1…q10, the SUS answers, or sus, the score; efficiency (1…5);
/// tlx1…tlx6 or tlx (0…100); every other column is a measure of its own. Numbers may have decimal
/// commas where commas do not separate. An empty cell is a missing value, which the row says.
/// Throws Error, "name:line: …", for everything else that is not as it should be: a number out of
/// its range, text that is no number, a participant twice in a mode, and as read_delimited().
StudyTable parse_study_csv(std::string_view text, const std::string& name);

/// The same of a file of at most kMostCsvBytes.
StudyTable read_study_csv(const std::filesystem::path& path);

}  // namespace clipgs
