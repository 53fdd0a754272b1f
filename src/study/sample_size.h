#pragma once

#include <cstddef>
#include <optional>

namespace clipgs {

/// The smallest effect a sample size is sought for; below it some 80 000 pairs do not do.
inline constexpr double kLeastEffect = 0.01;
/// Larger ones count as this one, for which next to no pairs do; further out the noncentral t
/// cannot be computed.
inline constexpr double kLargestEffect = 50;

/// What a study is planned for.
struct PowerTarget {
  double power = 0.8;   ///< in (0, 1), above alpha
  double alpha = 0.05;  ///< two-sided, in (0, 1)
};

/// Throws Error for a power or alpha out of range.
void require_valid(const PowerTarget& target);

/// Probability that a two-sided paired t-test at `alpha` finds an effect of d_z with n ≥ 2 pairs:
/// that a noncentral t of n − 1 degrees of freedom and noncentrality d_z·√n lies beyond the
/// critical values (Cohen 1988).
double paired_t_power(double dz, size_t n, double alpha);

/// The fewest pairs with at least that power, 2 or more; empty for an effect smaller than
/// kLeastEffect either way. Throws Error as require_valid(), and for an effect that is not finite.
std::optional<size_t> paired_t_sample_size(double dz, const PowerTarget& target = {});

/// The same for Wilcoxon's signed-rank test: the t-test's over the test's asymptotic efficiency
/// relative to it for normal differences, 3/π (Lehmann 1975), rounded up; and at least as many as
/// its exact p, which is never below 2 / 2ⁿ, takes to reach alpha.
std::optional<size_t> wilcoxon_sample_size(double dz, const PowerTarget& target = {});

}  // namespace clipgs
