#include "volume/light_rig.h"

#include <algorithm>
#include <cmath>

namespace clipgs {
namespace {

// Beside a lamp: as much of the sky as shows what it does not shine on.
constexpr float kSkyBesideLamp = 0.35f;
constexpr float kLeastLamp = 1.5f;
constexpr float kLampDegrees = 3;
const Vec3 kLampColor(1, 0.97f, 0.92f);

}  // namespace

LightRig turned(const LightRig& rig, float degrees) {
  LightRig result = rig;
  const float angle = glm::radians(degrees);
  for (KeyLight& key : result.keys) {
    const Vec3& d = key.direction;
    key.direction = {std::cos(angle) * d.x - std::sin(angle) * d.y,
                     std::sin(angle) * d.x + std::cos(angle) * d.y, d.z};
  }
  result.environment_turn -= angle;
  return result;
}

LightRig lamp_instead(const LightRig& rig, const Vec3& direction) {
  LightRig result;
  result.sky_top = kSkyBesideLamp * rig.sky_top;
  result.sky_horizon = kSkyBesideLamp * rig.sky_horizon;
  result.sky_bottom = kSkyBesideLamp * rig.sky_bottom;
  // As bright as the lamps whose place it takes.
  float strength = 0;
  for (const KeyLight& key : rig.keys) {
    strength += std::max({key.radiance.r, key.radiance.g, key.radiance.b});
  }
  result.keys = {{glm::normalize(direction), std::max(kLeastLamp, strength) * kLampColor,
                  glm::radians(kLampDegrees)}};
  return result;
}

}  // namespace clipgs
