#pragma once

#include <filesystem>

#include "study/comparison.h"

namespace clipgs {

/// Draws a panel for each measure that has pairs: every participant's two values joined by a line,
/// beside them boxes of the quartiles with whiskers to the outermost values within 1.5 times their
/// distance (Tukey), and the mean. What is written depends on the name's ending, .svg or .png (two
/// pixels a unit). Throws Error for another ending, for no pairs at all, and if it cannot be
/// written.
void write_study_plot(const StudyComparison& comparison, const std::filesystem::path& path);

}  // namespace clipgs
