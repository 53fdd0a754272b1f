#include "cinema/lights.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/geometry.h"

namespace clipgs {
Lights::Key::Sample Lights::Key::sample(const Vec3& seen_from, float u, float v) const {
  const float phi = 2.0f * kPi * v;
  const Vec3 across = std::cos(phi) * tangent + std::sin(phi) * bitangent;
  if (near) {
    const Vec3 way = position + radius * std::sqrt(u) * across - seen_from;
    const float distance2 = glm::dot(way, way);
    const Vec3 towards = way / std::sqrt(distance2);
    const float cosine = std::max(0.0f, glm::dot(towards, direction));  // at the lamp
    return {towards, intensity * (cosine / distance2)};
  }
  const float cos_theta = 1.0f - u * one_minus_cos;
  const float sin_theta = std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta));
  return {cos_theta * direction + sin_theta * across, irradiance};
}

Lights::Lights(const LightRig& rig, const Mat3& frame_from_world, const Vec3& extent)
    : sky_{frame_from_world * Vec3(0, 0, 1), rig.sky_horizon, rig.sky_top - rig.sky_horizon,
           rig.sky_bottom - rig.sky_horizon},
      middle_(0.5f * extent) {
  if (rig.keys.size() > LightRig::kMostKeys) {
    throw Error("light rig: {} key lights; at most {} are supported", rig.keys.size(),
                LightRig::kMostKeys);
  }
  for (const KeyLight& light : rig.keys) {
    Key key;
    key.direction = glm::normalize(frame_from_world * light.direction);
    orthonormal_basis(key.direction, key.tangent, key.bitangent);
    key.one_minus_cos = 1.0f - std::cos(light.angular_radius);
    // The mean cosine over the disc is 1 − one_minus_cos/2; a facing surface still gets π·radiance.
    key.irradiance = light.radiance * (kPi / (1.0f - 0.5f * key.one_minus_cos));
    if (light.distance > 0) {
      const float distance = light.distance * 0.5f * glm::length(extent);
      key.near = true;
      key.position = middle_ + distance * key.direction;
      key.radius = distance * std::tan(light.angular_radius);
      // A disc of radiance L gives π·L·r²/(r² + d²) to what faces it on its axis, at distance d;
      // one point of it gives L·π·r²·cos/distance².
      key.intensity = light.radiance * (kPi * (key.radius * key.radius + distance * distance));
    }
    keys_.push_back(key);
  }
  if (rig.environment) {
    environment_ =
        std::make_unique<EnvironmentMap>(*rig.environment, rig.environment_turn, frame_from_world);
  }
}

Vec3 Lights::face_radiance(const Vec3& normal, Keys which) const {
  Vec3 tangent;
  Vec3 bitangent;
  orthonormal_basis(normal, tangent, bitangent);
  // Cosine-weighted directions on a regular grid: the estimate is the plain mean of the radiance.
  constexpr int kRings = 32;
  constexpr int kSpokes = 64;
  Vec3 sum(0);
  for (int i = 0; i < kRings; ++i) {
    const float r2 = (static_cast<float>(i) + 0.5f) / kRings;
    const float r = std::sqrt(r2);
    const float height = std::sqrt(1.0f - r2);
    for (int j = 0; j < kSpokes; ++j) {
      const float phi = 2.0f * kPi * (static_cast<float>(j) + 0.5f) / kSpokes;
      sum += gradient_radiance(r * (std::cos(phi) * tangent + std::sin(phi) * bitangent) +
                               height * normal);
    }
  }
  sum /= static_cast<float>(kRings * kSpokes);

  constexpr int kDisc = 16;
  for (const Key& key : keys_) {
    if (key.near && which == Keys::kDistant) {
      continue;
    }
    Vec3 irradiance(0);
    for (int i = 0; i < kDisc; ++i) {
      for (int j = 0; j < kDisc; ++j) {
        const Key::Sample light = key.sample(middle_, (static_cast<float>(i) + 0.5f) / kDisc,
                                             (static_cast<float>(j) + 0.5f) / kDisc);
        irradiance += std::max(0.0f, glm::dot(normal, light.towards)) * light.irradiance;
      }
    }
    sum += irradiance / (kDisc * kDisc * kPi);
  }
  if (environment_) {
    sum += environment_->face_radiance(normal);
  }
  return sum;
}

}  // namespace clipgs
