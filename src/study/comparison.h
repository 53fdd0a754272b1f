#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "study/descriptives.h"
#include "study/paired_t.h"
#include "study/sample_size.h"
#include "study/shapiro_wilk.h"
#include "study/study_table.h"
#include "study/wilcoxon.h"

namespace clipgs {

/// Fewest pairs that are tested.
inline constexpr size_t kFewestPairs = 3;
/// Where Shapiro and Wilk's p of the differences lies below it, Wilcoxon's test is suggested.
inline constexpr double kNormalityLevel = 0.05;

/// One participant's values in the two modes.
struct MeasurePair {
  std::string participant;
  double first = 0;
  double second = 0;
};

/// Who is left out of a comparison, and why.
struct Exclusion {
  std::string participant;
  std::string measure;  ///< "" for every measure
  std::string reason;
};

enum class PairedTest : std::uint8_t { kNone, kT, kWilcoxon };

/// Pairs that a study of the same effect needs, by the test it will use.
struct SampleSizes {
  size_t t = 0;
  size_t wilcoxon = 0;
};

/// One measure in two modes; what is not defined for its pairs is empty.
struct MeasureComparison {
  std::string measure;
  std::vector<MeasurePair> pairs;  ///< by participant
  std::optional<Descriptives> first;
  std::optional<Descriptives> second;
  std::optional<Descriptives> difference;  ///< first − second
  std::string note;                        ///< why something is not tested
  std::optional<ShapiroWilk> normality;    ///< of the differences
  std::optional<PairedT> t;
  std::optional<Wilcoxon> wilcoxon;
  PairedTest suggested = PairedTest::kNone;
  std::optional<double> p;       ///< of the suggested test; Wilcoxon's exact one where there is one
  std::optional<double> holm_p;  ///< … corrected for the number of measures that were tested
  std::optional<SampleSizes> sizes;  ///< for the observed d_z
};

/// What a comparison of two modes is asked for.
struct ComparisonOptions {
  /// Two of the table's modes, the difference being first − second. Empty: the table's two, those
  /// of ClipGS-VR uniaxial first, others by name.
  std::optional<std::array<std::string, 2>> modes;
  PowerTarget target;            ///< its alpha is that of the intervals, too
  std::optional<double> effect;  ///< a d_z to plan for
};

/// What a comparison of two modes comes to.
struct StudyComparison {
  std::array<std::string, 2> modes;
  size_t participants = 0;  ///< all that have a row
  PowerTarget target;
  std::vector<Exclusion> exclusions;
  std::vector<std::string> remarks;  ///< those of the table
  std::vector<MeasureComparison> measures;
  std::optional<double> effect;      ///< as asked for …
  std::optional<SampleSizes> sizes;  ///< … and the pairs it needs; empty if it is too small
};

/// Compares every measure of two modes over the participants who have it in both. Differences are
/// rounded to twelve digits of the measure's largest value: what is equal on paper is equal here.
/// Throws Error for modes that the table does not have, for another number of modes than two
/// without a choice, and options out of range.
StudyComparison compare_modes(const StudyTable& table, const ComparisonOptions& options = {});

}  // namespace clipgs
