#pragma once

#include <array>

#include "splat/gaussians.h"

namespace clipgs {

/// A convex body around Gaussians: between two planes across each of a few directions.
struct Hull {
  static constexpr int kDirections = 32;
  /// Of all hulls: unit, the axes first and then a half of those spread over the sphere.
  static const std::array<Vec3, kDirections>& directions();

  /// Around the means of the Gaussians that are not faint, and their largest deviation farther;
  /// `low` above `high` if there are none.
  explicit Hull(const Gaussians& gaussians);

  std::array<float, kDirections> low;  ///< mm along each direction
  std::array<float, kDirections> high;
};

}  // namespace clipgs
