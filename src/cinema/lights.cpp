#include "cinema/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace clipgs {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

Vec3 Lights::Key::sample(float u, float v) const {
  const float cos_theta = 1.0f - u * one_minus_cos;
  const float sin_theta = std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta));
  const float phi = 2.0f * kPi * v;
  return cos_theta * direction + sin_theta * (std::cos(phi) * tangent + std::sin(phi) * bitangent);
}

Lights::Lights(const LightRig& rig, const Mat3& frame_from_world)
    : sky_{frame_from_world * Vec3(0, 0, 1), rig.sky_horizon, rig.sky_top - rig.sky_horizon,
           rig.sky_bottom - rig.sky_horizon} {
  if (rig.keys.size() > kMaxKeys) {
    throw Error("light rig: {} key lights; at most {} are supported", rig.keys.size(), kMaxKeys);
  }
  for (const KeyLight& light : rig.keys) {
    Key key;
    key.direction = glm::normalize(frame_from_world * light.direction);
    orthonormal_basis(key.direction, key.tangent, key.bitangent);
    key.one_minus_cos = 1.0f - std::cos(light.angular_radius);
    // The mean cosine over the disc is 1 − one_minus_cos/2; a facing surface still gets π·radiance.
    key.irradiance = light.radiance * (kPi / (1.0f - 0.5f * key.one_minus_cos));
    keys_.push_back(key);
  }
  if (rig.environment) {
    environment_ =
        std::make_unique<EnvironmentMap>(*rig.environment, rig.environment_turn, frame_from_world);
  }
}

Vec3 Lights::face_radiance(const Vec3& normal) const {
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
    float cosine = 0;
    for (int i = 0; i < kDisc; ++i) {
      for (int j = 0; j < kDisc; ++j) {
        const Vec3 towards = key.sample((static_cast<float>(i) + 0.5f) / kDisc,
                                        (static_cast<float>(j) + 0.5f) / kDisc);
        cosine += std::max(0.0f, glm::dot(normal, towards));
      }
    }
    sum += key.irradiance * (cosine / (kDisc * kDisc * kPi));
  }
  if (environment_) {
    sum += environment_->face_radiance(normal);
  }
  return sum;
}

Vec3 Lights::mean_radiance() const {
  // The mean of |z| over the sphere is 1/2, half of it above and half below the horizon.
  Vec3 mean = sky_.horizon + 0.25f * (sky_.to_top + sky_.to_bottom);
  for (const Key& key : keys_) {
    mean += key.irradiance / (4.0f * kPi);
  }
  if (environment_) {
    mean += environment_->mean_radiance();
  }
  return mean;
}

}  // namespace clipgs
