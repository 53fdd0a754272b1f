#pragma once

#include <memory>
#include <vector>

#include "cinema/environment_map.h"
#include "core/geometry.h"
#include "volume/preset.h"

namespace clipgs {

/// Of linear sRGB, by dot product.
inline constexpr Vec3 kLuminance{0.2126f, 0.7152f, 0.0722f};

/// A light rig turned into the frame that paths are traced in: the grid frame of scene.h.
class Lights {
 public:
  /// `frame_from_world` rotates RAS directions into the tracing frame; `extent` is the size of the
  /// volume's box, mm, one corner of which is the frame's origin. Throws Error for more than
  /// LightRig::kMostKeys key lights.
  Lights(const LightRig& rig, const Mat3& frame_from_world, const Vec3& extent);

  /// A disc that lights the scene, from afar or near.
  struct Key {
    Vec3 direction;  ///< unit vector towards the middle of the disc
    Vec3 tangent, bitangent;
    Vec3 irradiance;      ///< of a surface that faces the disc, linear RGB
    float one_minus_cos;  ///< 1 − cos(angular radius)
    // Of a lamp at a finite distance:
    bool near = false;
    Vec3 position{0};   ///< of the disc's middle, mm
    float radius = 0;   ///< mm
    Vec3 intensity{0};  ///< irradiance · mm² of what faces the lamp on its axis, linear RGB

    /// Light from one point of the disc.
    struct Sample {
      Vec3 towards;     ///< unit vector
      Vec3 irradiance;  ///< of a surface that faces there, linear RGB
    };
    /// A point of the disc, evenly drawn for uniform u, v in [0, 1), as seen from `seen_from`, mm.
    Sample sample(const Vec3& seen_from, float u, float v) const;
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

  /// Which key lights count.
  enum class Keys { kAll, kDistant };
  /// What a white Lambert face with this normal and nothing above it radiates, linear RGB, in the
  /// middle of the volume: (1/π)·∫ L(ω) max(0, n·ω) dω over sky and key lights, by quadrature.
  Vec3 face_radiance(const Vec3& normal, Keys which = Keys::kAll) const;

 private:
  Vec3 gradient_radiance(const Vec3& direction) const {
    const float up = glm::dot(sky_.up, direction);
    return up >= 0 ? sky_.horizon + up * sky_.to_top : sky_.horizon - up * sky_.to_bottom;
  }

  std::vector<Key> keys_;
  Sky sky_;
  Vec3 middle_;  // of the volume's box, mm
  std::unique_ptr<const EnvironmentMap> environment_;
};

}  // namespace clipgs
