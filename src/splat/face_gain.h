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
    return step((T{kNone} - depth) / T{kNone - kWhole});
  }
  /// Its derivative.
  static float share_slope(float depth) {
    return -step_slope((kNone - depth) / (kNone - kWhole)) / (kNone - kWhole);
  }

  /// A face is seen from the removed side alone: from there to where the cosine of the angle
  /// between the plane's normal and the way from the eye to the splat is this …
  static constexpr float kFacing = 0.03f;
  /// … a smooth step takes what share() leaves from 0 to 1.
  template <typename T>
  static T facing(T cosine) {
    return step(cosine / T{kFacing});
  }
  static float facing_slope(float cosine) { return step_slope(cosine / kFacing) / kFacing; }

 private:
  template <typename T>
  static T step(T u) {
    return u <= 0 ? T{0} : u >= 1 ? T{1} : u * u * (3 - 2 * u);
  }
  static float step_slope(float u) { return u <= 0 || u >= 1 ? 0 : 6 * u * (1 - u); }
};

}  // namespace clipgs
