#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace clipgs {

/// Most differences other than 0 for which the exact distribution is counted.
inline constexpr size_t kMostExactPairs = 25;

/// Wilcoxon's signed-rank test (Wilcoxon 1945). Differences of 0 are dropped, equal sizes share the
/// mean of their ranks.
struct Wilcoxon {
  size_t n = 0;      ///< differences other than 0
  size_t zeros = 0;  ///< … and those that are
  double plus = 0;   ///< sum of the ranks of positive differences
  double minus = 0;  ///< … and of negative ones
  double w = 0;      ///< the smaller of the two
  /// (W − n(n + 1)/4) over its standard deviation √(n(n + 1)(2n + 1)/24 − Σ(t³ − t)/48), t the
  /// sizes of groups of ties; never positive. No continuity correction, as in SPSS.
  double z = 0;
  double p = 0;  ///< two-sided, of the normal distribution
  /// Two-sided, 2·P(smaller sum ≤ W) among all 2ⁿ signs of the ranks as they are, ties included;
  /// empty for more than kMostExactPairs.
  std::optional<double> exact_p;
  /// Matched-pairs rank-biserial correlation (plus − minus) / (plus + minus) (Kerby 2014), −1…1.
  double r = 0;
};

/// Empty where all differences are 0. Throws Error for no differences, or one that is not finite.
std::optional<Wilcoxon> wilcoxon_signed_rank(std::span<const double> differences);

}  // namespace clipgs
