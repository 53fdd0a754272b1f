#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace clipgs {

inline constexpr size_t kFewestForShapiroWilk = 3;
inline constexpr size_t kMostForShapiroWilk = 5000;

/// The test of Shapiro & Wilk (1965) whether values may come from a normal distribution.
struct ShapiroWilk {
  double w = 0;  ///< 0…1, 1 for values as a normal distribution has them
  double p = 0;
};

/// By Royston's approximation (Applied Statistics 44, 1995, algorithm AS R94), as R has it. Of 3 to
/// 5000 values in any order; empty where they are all equal. Throws Error for another number of
/// values, or one that is not finite.
std::optional<ShapiroWilk> shapiro_wilk(std::span<const double> values);

}  // namespace clipgs
