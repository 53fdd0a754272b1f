#pragma once

#include <optional>
#include <span>

#include "study/descriptives.h"

namespace clipgs {

/// Student's t-test of paired samples. Signs are those of the differences.
struct PairedT {
  double t = 0;
  double df = 0;
  double p = 0;                   ///< two-sided
  double mean = 0;                ///< of the differences, in their unit
  Interval mean_ci;               ///< of that mean
  double dz = 0;                  ///< Cohen's d_z: mean / SD of the differences
  std::optional<Interval> dz_ci;  ///< empty where the noncentral t cannot be computed
};

/// Of at least two differences; empty where they are all equal, for there is no t then. Intervals
/// have the confidence 1 − alpha. That of d_z holds the noncentralities, over √n, of the noncentral
/// t distributions whose outer alpha / 2 the observed t does not reach (Cumming & Finch 2001).
/// Throws Error for fewer differences, or one that is not finite.
std::optional<PairedT> paired_t(std::span<const double> differences, double alpha = 0.05);

}  // namespace clipgs
