#include "section/face_light.h"

#include <algorithm>
#include <cmath>

#include "light/sky.h"

#include "cinema/scatter.h"
#include "core/geometry.h"

namespace clipgs {
namespace {

const Vec3 kUp(0, 0, 1);  // the sky's gradient runs along S

/// Mean of max(0, n·ω) over a disc of angular radius asin(s) about a direction at cosine `c`,
/// relative to what it is where the disc faces the plane: exact for a flat disc.
float disc_cosine(float c, float s) {
  if (c >= s) {
    return c;
  }
  if (c <= -s) {
    return 0;
  }
  const float u = c / s;
  const float root = std::sqrt(std::max(0.0f, 1 - u * u));
  return s * (u * (0.5f + (std::asin(u) + u * root) / kPi) + 2 / (3 * kPi) * root * root * root);
}

/// (1/π)·∫ max(0, a·ω)·max(0, b·ω) dω over the sphere, for cos of the angle between a and b.
float overlap(float cosine) {
  const float c = std::clamp(cosine, -1.0f, 1.0f);
  const float angle = std::acos(c);
  return 2 / (3 * kPi) * (std::sin(angle) + (kPi - angle) * c);
}

/// Share of a uniform white sky that the GGX lobe with α = `roughness` returns: Karis's fit of the
/// split sum (2014), which for F = 1 does not depend on the angle.
float lobe_reflectance(float roughness) { return 1 - 0.55f * std::sqrt(roughness); }

}  // namespace

Vec3 face_diffuse(const LightRig& rig, const Vec3& normal) {
  const float up = glm::dot(kUp, normal);
  Vec3 sum = rig.sky_horizon + overlap(up) * (rig.sky_top - rig.sky_horizon) +
             overlap(-up) * (rig.sky_bottom - rig.sky_horizon);
  for (const KeyLight& key : rig.keys) {
    const float cosine = glm::dot(normal, key.direction);
    sum += disc_cosine(cosine, std::sin(key.angular_radius)) * key.radiance;
  }
  return sum;
}

Vec3 face_gloss(const LightRig& rig, const Vec3& normal, const Vec3& out, float roughness) {
  const float cosine = glm::dot(normal, out);
  if (cosine <= 0) {
    return Vec3(0);
  }
  const Vec3 mirrored = 2 * cosine * normal - out;
  Vec3 sum = lobe_reflectance(roughness) * sky_radiance(rig, mirrored);
  for (const KeyLight& key : rig.keys) {
    const float spread = 0.5f * key.angular_radius;
    const float wider = std::min(1.0f, std::sqrt(roughness * roughness + spread * spread));
    sum += ggx::evaluate(normal, out, key.direction, wider) * kPi * key.radiance;
  }
  return sum;
}

}  // namespace clipgs
