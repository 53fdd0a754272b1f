#pragma once

#include "volume/light_rig.h"

namespace clipgs {

/// Radiance of a rig's smooth sky from a unit direction (RAS), linear RGB: its gradient runs along
/// S.
inline Vec3 sky_radiance(const LightRig& rig, const Vec3& direction) {
  const float up = direction.z;
  return up >= 0 ? glm::mix(rig.sky_horizon, rig.sky_top, up)
                 : glm::mix(rig.sky_horizon, rig.sky_bottom, -up);
}

}  // namespace clipgs
