#pragma once

#include <memory>
#include <vector>

#include "cinema/environment_map.h"
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

  /// Radiance from horizon to top (bottom) linearly in the sine of the elevation.
  struct Sky {
    Vec3 up;
    Vec3 horizon, to_top, to_bottom;
  };
  const Sky& gradient() const { return sky_; }
  /// May be null.
  const EnvironmentMap* environment() const { return environment_.get(); }

  /// Radiance of gradient and environment from unit `direction`.
  Vec3 sky(const Vec3& direction) const {
    const Vec3 gradient = gradient_radiance(direction);
    return environment_ ? gradient + environment_->radiance(direction) : gradient;
  }

  /// What a white Lambert face with this normal and nothing above it radiates, linear RGB:
  /// (1/π)·∫ L(ω) max(0, n·ω) dω over sky and key lights, by quadrature.
  Vec3 face_radiance(const Vec3& normal) const;

  /// Mean radiance over the sphere of directions: what an unshadowed isotropic scatterer of albedo
  /// 1 radiates.
  Vec3 mean_radiance() const;

 private:
  Vec3 gradient_radiance(const Vec3& direction) const {
    const float up = glm::dot(sky_.up, direction);
    return up >= 0 ? sky_.horizon + up * sky_.to_top : sky_.horizon - up * sky_.to_bottom;
  }

  std::vector<Key> keys_;
  Sky sky_;
  std::unique_ptr<const EnvironmentMap> environment_;
};

}  // namespace clipgs
