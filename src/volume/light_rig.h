#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

struct Image;

/// A light with a disc of some size; fixed in the patient's space.
struct KeyLight {
  Vec3 direction{0, 1, 0};      ///< unit RAS vector towards the light
  Vec3 radiance{1};             ///< irradiance that a facing white surface receives / π, linear RGB
  float angular_radius = 0.1f;  ///< radians, 0 for a point
  /// From the middle of the volume's box, in half diagonals of it, > 1: a lamp that faces the
  /// middle, seen from there as the numbers above say. 0: infinitely far away.
  float distance = 0;
};

/// Lights of a scene: a smooth sky (vertical gradient along S), any number of key lights, and what
/// a panorama shows.
struct LightRig {
  static constexpr size_t kMostKeys = 8;
  Vec3 sky_top{1};      ///< environment radiance from superior, linear RGB
  Vec3 sky_horizon{1};  ///< … from the horizon
  Vec3 sky_bottom{1};   ///< … from inferior
  std::vector<KeyLight> keys;
  /// [height, width, 3], linear radiance: superior at the top, anterior in the middle. May be null.
  std::shared_ptr<const Image> environment = nullptr;
  float environment_turn = 0;  ///< radians, towards the patient's right
};

/// Turned about the patient's long axis, counterclockwise seen from the head.
LightRig turned(const LightRig& rig, float degrees);

/// A lamp that shines from a direction (RAS, not 0) instead of the rig's, beside a darker sky.
LightRig lamp_instead(const LightRig& rig, const Vec3& direction);

}  // namespace clipgs
