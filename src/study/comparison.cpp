#include "study/comparison.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <set>

#include "core/error.h"
#include "study/holm.h"

namespace clipgs {

namespace {

using ModePair = std::array<std::string, 2>;

/// Rows of the two modes by participant, in the participants' order; nullptr where there is none.
using RowsOfParticipants = std::map<std::string, std::array<const StudyRow*, 2>,
                                    bool (*)(const std::string&, const std::string&)>;

ModePair choose_modes(const StudyTable& table, const std::optional<ModePair>& wanted) {
  std::set<std::string> modes;
  for (const StudyRow& row : table.rows) {
    modes.insert(row.mode);
  }
  if (wanted) {
    for (const std::string& mode : *wanted) {
      if (!modes.contains(mode)) {
        throw Error("there is no mode {} in the data; choose two of: {}", mode,
                    fmt::join(modes, ", "));
      }
    }
    if (wanted->front() == wanted->back()) {
      throw Error("{} cannot be compared with itself; choose two of: {}", wanted->front(),
                  fmt::join(modes, ", "));
    }
    return *wanted;
  }
  if (modes.size() != 2) {
    throw Error("two modes are compared, but the data have {}: {}; {}", modes.size(),
                fmt::join(modes, ", "),
                modes.size() > 2 ? "choose two with --modes A,B" : "add the other mode's rows");
  }
  if (modes == std::set<std::string>{"arbitrary", "uniaxial"}) {
    return {"uniaxial", "arbitrary"};
  }
  return {*modes.begin(), *modes.rbegin()};
}

/// Why a row has no value of a measure; "" if it has.
std::string missing_reason(const StudyRow& row, const std::string& measure) {
  if (row.values.contains(measure)) {
    return {};
  }
  const auto known = row.missing.find(measure);
  return known == row.missing.end() ? fmt::format("not recorded at {}", row.place) : known->second;
}

void collect_pairs(MeasureComparison& comparison, const RowsOfParticipants& rows,
                   std::vector<Exclusion>& exclusions) {
  for (const auto& [participant, both] : rows) {
    if (both[0] == nullptr || both[1] == nullptr) {
      continue;  // is left out of every measure, and said to be
    }
    std::vector<std::string> reasons;
    for (const StudyRow* row : both) {
      if (const std::string reason = missing_reason(*row, comparison.measure); !reason.empty()) {
        reasons.push_back(reason);
      }
    }
    if (reasons.empty()) {
      comparison.pairs.push_back({participant, both[0]->values.at(comparison.measure),
                                  both[1]->values.at(comparison.measure)});
    } else {
      exclusions.push_back(
          {participant, comparison.measure, fmt::format("{}", fmt::join(reasons, "; "))});
    }
  }
}

/// Differences of decimals, as 0.3 − 0.1 and 0.5 − 0.3, differ in their last bits: ties and zeros
/// would not be seen.
std::vector<double> rounded_differences(const std::vector<MeasurePair>& pairs) {
  double largest = 0;
  for (const MeasurePair& pair : pairs) {
    largest = std::max({largest, std::abs(pair.first), std::abs(pair.second)});
  }
  const int digits = largest > 0 ? 11 - static_cast<int>(std::floor(std::log10(largest))) : 0;
  const double unit = std::pow(10.0, std::abs(digits));
  std::vector<double> differences;
  for (const MeasurePair& pair : pairs) {
    const double difference = pair.first - pair.second;
    differences.push_back(digits < 0 ? std::round(difference / unit) * unit
                                     : std::round(difference * unit) / unit);
  }
  return differences;
}

void suggest_test(MeasureComparison& comparison) {
  if (!comparison.wilcoxon) {
    return;
  }
  const bool normal =
      comparison.t && comparison.normality && comparison.normality->p >= kNormalityLevel;
  comparison.suggested = normal ? PairedTest::kT : PairedTest::kWilcoxon;
  comparison.p =
      normal ? comparison.t->p : comparison.wilcoxon->exact_p.value_or(comparison.wilcoxon->p);
}

std::optional<SampleSizes> sample_sizes(double dz, const PowerTarget& target) {
  const std::optional<size_t> t = paired_t_sample_size(dz, target);
  return t ? std::optional(SampleSizes{*t, *wilcoxon_sample_size(dz, target)}) : std::nullopt;
}

void test_differences(MeasureComparison& comparison, const std::vector<double>& differences,
                      const PowerTarget& target) {
  if (differences.size() < kFewestPairs) {
    comparison.note = fmt::format("no test: {} {}, and at least {} are needed", differences.size(),
                                  differences.size() == 1 ? "pair" : "pairs", kFewestPairs);
    return;
  }
  comparison.wilcoxon = wilcoxon_signed_rank(differences);
  if (!comparison.wilcoxon) {
    comparison.note = "no test: all differences are 0";
    return;
  }
  comparison.t = paired_t(differences, target.alpha);
  if (!comparison.t) {
    comparison.note = "no t-test: all differences are equal";
  } else if (differences.size() > kMostForShapiroWilk) {
    comparison.note = fmt::format("whether differences are normal is tested for up to {} pairs",
                                  kMostForShapiroWilk);
  } else {
    comparison.normality = shapiro_wilk(differences);
  }
  if (comparison.t) {
    comparison.sizes = sample_sizes(comparison.t->dz, target);
  }
  suggest_test(comparison);
}

MeasureComparison compare_measure(const std::string& measure, const RowsOfParticipants& rows,
                                  const PowerTarget& target, std::vector<Exclusion>& exclusions) {
  MeasureComparison result;
  result.measure = measure;
  collect_pairs(result, rows, exclusions);
  if (!result.pairs.empty()) {
    std::vector<double> first;
    std::vector<double> second;
    for (const MeasurePair& pair : result.pairs) {
      first.push_back(pair.first);
      second.push_back(pair.second);
    }
    result.first = describe(first, target.alpha);
    result.second = describe(second, target.alpha);
    result.difference = describe(rounded_differences(result.pairs), target.alpha);
  }
  test_differences(result, rounded_differences(result.pairs), target);
  return result;
}

void correct_for_measures(std::vector<MeasureComparison>& measures) {
  std::vector<double> p;
  for (const MeasureComparison& measure : measures) {
    if (measure.p) {
      p.push_back(*measure.p);
    }
  }
  const std::vector<double> corrected = holm(p);
  auto next = corrected.begin();
  for (MeasureComparison& measure : measures) {
    if (measure.p) {
      measure.holm_p = *next++;
    }
  }
}

}  // namespace

StudyComparison compare_modes(const StudyTable& table, const ComparisonOptions& options) {
  StudyComparison result;
  result.modes = choose_modes(table, options.modes);
  result.target = options.target;
  result.remarks = table.remarks;
  result.effect = options.effect;
  require_valid(options.target);
  if (options.effect) {
    result.sizes = sample_sizes(*options.effect, options.target);
  }
  RowsOfParticipants rows(participant_order);
  for (const StudyRow& row : table.rows) {
    const auto* const mode = std::ranges::find(result.modes, row.mode);
    auto& both = rows.try_emplace(row.participant).first->second;
    if (mode != result.modes.end()) {
      both[static_cast<size_t>(mode - result.modes.begin())] = &row;
    }
  }
  result.participants = rows.size();
  for (const auto& [participant, both] : rows) {
    for (size_t i = 0; i < both.size(); ++i) {
      if (both[i] == nullptr && both[1 - i] != nullptr) {
        result.exclusions.push_back(
            {participant, "", fmt::format("has no row in mode {}", result.modes[i])});
      } else if (i == 0 && both[0] == nullptr) {
        result.exclusions.push_back({participant, "", "has a row in neither mode"});
      }
    }
  }
  for (const std::string& measure : table.measures) {
    result.measures.push_back(compare_measure(measure, rows, options.target, result.exclusions));
  }
  correct_for_measures(result.measures);
  return result;
}

}  // namespace clipgs
