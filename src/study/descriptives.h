#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace clipgs {

/// Both ends belong to it.
struct Interval {
  double low = 0;
  double high = 0;
};

/// What describes a sample, in the values' own unit.
struct Descriptives {
  size_t n = 0;
  double mean = 0;
  std::optional<double> sd;  ///< n − 1 in the denominator; empty for one value
  double median = 0;
  double q1 = 0;  ///< quartiles as quantile() has them
  double q3 = 0;
  double min = 0;
  double max = 0;
  std::optional<Interval> mean_ci;  ///< of the mean, by Student's t; empty for one value

  double iqr() const { return q3 - q1; }
};

/// Of at least one value, in any order: the result is the same to the last bit. The interval has
/// the confidence 1 − alpha (0 < alpha < 1). Throws Error for no values, or one that is not finite.
Descriptives describe(std::span<const double> values, double alpha = 0.05);

/// The quantile of a share (0…1) of ascending values, at least one: linear between the order
/// statistics at 1 + (n − 1)·share, type 7 of Hyndman & Fan (1996), the default of R and numpy.
double quantile(std::span<const double> ascending, double share);

/// The quantile of Student's t with `df` degrees of freedom above which the share alpha / 2 lies.
double t_critical(double df, double alpha);

}  // namespace clipgs
