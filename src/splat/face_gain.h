#pragma once

#include <array>

#include "core/geometry.h"

namespace clipgs {

/// How bright a cut face is, by its plane's normal n: splats that a plane cuts have their colour
/// multiplied, channel by channel, by g(n) = exp(Σ cₖ·Yₖ(n)). A splat's own colour cannot follow
/// the light on a face, which depends on how the plane is turned and hardly on where it is seen
/// from; nothing stands above a face, so the same light falls on all of it (method.md §12).
struct FaceGain {
  static constexpr int kDegree = 3;
  static constexpr size_t kCoefficients = 16;
  std::array<Vec3, kCoefficients> coefficients{};  ///< RGB; all 0: no gain

  bool operator==(const FaceGain&) const = default;
  bool none() const { return *this == FaceGain(); }
  Vec3 at(const Vec3& normal) const;

  // A splat takes part in the gain down to this many of its standard deviations below the plane …
  static constexpr float kWhole = 1.5f;  ///< … wholly
  static constexpr float kNone = 3;      ///< … no more

  /// The share of the gain that a splat takes `depth` standard deviations below the plane: 1 down
  /// to kWhole, then a smooth step to 0 at kNone.
  template <typename T>
  static T share(T depth) {
    const T u = (T{kNone} - depth) / T{kNone - kWhole};
    return u <= 0 ? T{0} : u >= 1 ? T{1} : u * u * (3 - 2 * u);
  }
  /// Its derivative.
  static float share_slope(float depth) {
    const float u = (kNone - depth) / (kNone - kWhole);
    return u <= 0 || u >= 1 ? 0 : -6 * u * (1 - u) / (kNone - kWhole);
  }
};

}  // namespace clipgs
