#pragma once

#include <string>
#include <vector>

#include "study/comparison.h"
#include "study/report_blocks.h"

namespace clipgs {

/// What a comparison found, for a person: what was left out, a row of figures and one of tests for
/// each measure, what SUS scores mean, and how many pairs another study needs.
std::vector<ReportBlock> study_report(const StudyComparison& comparison);

/// The same for programs, with all digits: {"modes", "participants", "alpha", "power", "excluded":
/// [{"participant", "measure", "reason"}], "remarks", "measures": [{"measure", "title", "unit",
/// "n", "first", "second", "difference", "normality", "t", "wilcoxon", "suggested", "p", "holm_p",
/// "sample_size", "note", "pairs": [{"participant", "first", "second"}]}], "planned"}; null where
/// something is not defined. docs/study_analysis.md says what each is.
std::string study_json(const StudyComparison& comparison);

/// As papers print it: "p = .015", "p < .001".
std::string p_text(double p);
/// A number within ±1 without the zero before its point, with a minus sign: "−.73".
std::string share_text(double value, int decimals);
/// With a minus sign instead of a stroke; none where the digits are all 0.
std::string signed_text(double value, int decimals);

}  // namespace clipgs
