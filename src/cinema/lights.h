#pragma once

#include <vector>

#include "core/geometry.h"
#include "volume/preset.h"

namespace clipgs {

/// A light rig turned into the frame that paths are traced in.
class Lights {
 public:
  static constexpr size_t kMaxKeys = 8;

  /// `frame_from_world` rotates RAS directions into the tracing frame. Throws Error for more than
  /// kMaxKeys key lights.
  Lights(const LightRig& rig, const Mat3& frame_from_world);

  struct Key {
    Vec3 direction;  ///< unit vector towards the middle of the disc
    Vec3 tangent, bitangent;
    Vec3 irradiance;      ///< of a surface that faces the disc, linear RGB
    float one_minus_cos;  ///< 1 − cos(angular radius)

    /// A direction towards the disc, uniform in solid angle for uniform u, v in [0, 1).
    Vec3 sample(float u, float v) const;
  };

  const std::vector<Key>& keys() const { return keys_; }

  /// Radiance of the sky from unit `direction`: horizon to top (bottom) linearly in the sine of
  /// the elevation.
  Vec3 sky(const Vec3& direction) const {
    const float up = glm::dot(up_, direction);
    return up >= 0 ? horizon_ + up * to_top_ : horizon_ - up * to_bottom_;
  }

  /// What a white Lambert face with this normal and nothing above it radiates, linear RGB:
  /// (1/π)·∫ L(ω) max(0, n·ω) dω over sky and key lights, by quadrature.
  Vec3 face_radiance(const Vec3& normal) const;

  /// Mean radiance over the sphere of directions: what an unshadowed isotropic scatterer of albedo
  /// 1 radiates.
  Vec3 mean_radiance() const;

 private:
  std::vector<Key> keys_;
  Vec3 up_;
  Vec3 horizon_, to_top_, to_bottom_;
};

}  // namespace clipgs
