#include "light/cut_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "light/sky.h"

#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr auto kSky = static_cast<size_t>(CutLight::kSkyRays);
constexpr auto kKey = static_cast<size_t>(CutLight::kKeyRays);
constexpr size_t kPatchesATurn = 256;
// Of the occluders' spacing: matter nearer than this, blurred by their grid, is the surface itself.
constexpr float kStart = 0.5f;
constexpr float kGolden = 0.61803399f;

/// Ray i of those that are spread as the cosine is about the z axis.
const std::array<Vec3, kSky>& cosine_rays() {
  static const std::array<Vec3, kSky> rays = [] {
    std::array<Vec3, kSky> spread;
    for (size_t i = 0; i < kSky; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / static_cast<float>(kSky);
      const float phi = 2 * kPi * kGolden * static_cast<float>(i);
      spread[i] =
          Vec3(std::sqrt(u) * std::cos(phi), std::sqrt(u) * std::sin(phi), std::sqrt(1 - u));
    }
    return spread;
  }();
  return rays;
}

/// Points of a disc of angular radius `radius` around a direction, as unit directions.
Vec3 key_ray(const KeyLight& key, size_t i) {
  Vec3 u;
  Vec3 v;
  orthonormal_basis(key.direction, u, v);
  const float r = std::sqrt((static_cast<float>(i) + 0.5f) / static_cast<float>(kKey)) *
                  std::tan(key.angular_radius);
  const float phi = 2 * kPi * kGolden * static_cast<float>(i);
  return glm::normalize(key.direction + r * (std::cos(phi) * u + std::sin(phi) * v));
}

}  // namespace

/// Calls use(i, origin, direction) for every ray of a patch to the sky. They begin in turns at the
/// patch's samples, and are turned about the normal by an angle of the patch's own: what few rays
/// miss differs from patch to patch, and interpolation evens it out.
template <typename Use>
void CutLight::each_sky_ray(size_t patch, const Use& use) const {
  const float turned = kGolden * static_cast<float>(patch);
  const float phi = 2 * kPi * (turned - std::floor(turned));
  const float c = std::cos(phi);
  const float s = std::sin(phi);
  for (size_t k = 0; k < Patches::kSamples; ++k) {
    const SurfacePoint& sample = patches_.sample(patch, k);
    Vec3 u;
    Vec3 v;
    orthonormal_basis(sample.normal, u, v);
    const Mat3 basis(c * u + s * v, c * v - s * u, sample.normal);
    const Vec3 origin = origin_of(sample);
    for (size_t i = k; i < kSky; i += Patches::kSamples) {
      use(i, origin, basis * cosine_rays()[i]);
    }
  }
}

CutLight::CutLight(Occluders occluders, Patches patches, const LightRig& rig, float lift)
    : occluders_(std::move(occluders)),
      empty_(find_empty_space(occluders_)),
      patches_(std::move(patches)),
      lift_(lift) {
  sky_.resize(patches_.count() * kSky);
  const float start = kStart * occluders_.spacing;
  parallel_for(patches_.count(), kPatchesATurn, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      each_sky_ray(p, [&](size_t i, const Vec3& from, const Vec3& direction) {
        const float distance = horizon_distance(occluders_, empty_, from, direction, start);
        sky_[p * kSky + i] = {
            distance, distance < kNever ? patches_.met_by(from + distance * direction, direction)
                                        : Patches::kNone};
      });
    }
  });
  set_rig(rig);
}

void CutLight::set_rig(const LightRig& rig) {
  rig_ = rig;
  key_directions_.clear();
  for (const KeyLight& key : rig.keys) {
    for (size_t i = 0; i < kKey; ++i) {
      key_directions_.push_back(key_ray(key, i));
    }
  }
  keys_.resize(patches_.count() * key_directions_.size());
  const float start = kStart * occluders_.spacing;
  parallel_for(patches_.count(), kPatchesATurn, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      for (size_t i = 0; i < key_directions_.size(); ++i) {
        const SurfacePoint& sample = key_sample(p, i);
        keys_[p * key_directions_.size() + i] =
            glm::dot(sample.normal, key_directions_[i]) > 0
                ? horizon_distance(occluders_, empty_, origin_of(sample), key_directions_[i], start)
                : 0;
      }
    }
  });
}

CutLight::Direct CutLight::direct(std::span<const Plane> planes) const {
  const size_t count = patches_.count();
  const size_t turns = (count + kPatchesATurn - 1) / kPatchesATurn;
  std::vector<Direct> parts(turns);
  Direct all;
  all.light.resize(count);
  parallel_for(count, kPatchesATurn, [&](size_t begin, size_t end) {
    Direct& part = parts[begin / kPatchesATurn];
    for (size_t p = begin; p < end; ++p) {
      part.first.push_back(static_cast<std::uint32_t>(part.met.size()));
      Vec3 sum(0);
      each_sky_ray(p, [&](size_t i, const Vec3& from, const Vec3& direction) {
        const Horizon& horizon = sky_[p * kSky + i];
        if (horizon.distance >= exit_distance(planes, from, direction)) {
          sum += sky_radiance(rig_, direction);
        } else if (horizon.patch != Patches::kNone) {
          part.met.push_back(horizon.patch);
        }
      });
      sum /= static_cast<float>(kSky);
      for (size_t i = 0; i < key_directions_.size(); ++i) {
        const SurfacePoint& sample = key_sample(p, i);
        const float cosine = glm::dot(sample.normal, key_directions_[i]);
        if (cosine > 0 && keys_[p * key_directions_.size() + i] >=
                              exit_distance(planes, origin_of(sample), key_directions_[i])) {
          sum += cosine / static_cast<float>(kKey) * rig_.keys[i / kKey].radiance;
        }
      }
      all.light[p] = sum;
    }
  });
  for (const Direct& part : parts) {
    for (const std::uint32_t first : part.first) {
      all.first.push_back(first + static_cast<std::uint32_t>(all.met.size()));
    }
    all.met.insert(all.met.end(), part.met.begin(), part.met.end());
  }
  all.first.push_back(static_cast<std::uint32_t>(all.met.size()));
  return all;
}

std::vector<Vec3> CutLight::solve(std::span<const Plane> planes, int bounces,
                                  std::span<const Vec3> from) const {
  const Direct first = direct(planes);
  std::vector<Vec3> light =
      from.empty() ? first.light : std::vector<Vec3>(from.begin(), from.end());
  std::vector<Vec3> radiated(light.size());
  for (int i = 0; i < bounces; ++i) {
    for (size_t p = 0; p < light.size(); ++p) {
      radiated[p] = patches_.all()[p].reflectance * light[p] / static_cast<float>(kSky);
    }
    parallel_for(light.size(), kPatchesATurn, [&](size_t begin, size_t end) {
      for (size_t p = begin; p < end; ++p) {
        Vec3 sum = first.light[p];
        for (std::uint32_t k = first.first[p]; k < first.first[p + 1]; ++k) {
          sum += radiated[static_cast<size_t>(first.met[k])];
        }
        light[p] = sum;
      }
    });
  }
  return light;
}

Vec3 light_at(const Patches& patches, std::span<const Vec3> solution, const Vec3& world,
              const Vec3& normal) {
  Vec3 sum(0);
  float weights = 0;
  const auto use = [&](size_t patch, float weight) {
    sum += weight * solution[patch];
    weights += weight;
  };
  patches.interpolate(world, normal, use);
  if (weights <= 0) {
    // Slivers whose normals say little: the light of whatever is there.
    const Vec3 all(std::numbers::inv_sqrt3_v<float>);
    const Mat3& axes = patches.grid().direction;
    patches.interpolate(world, axes * all, use);
    patches.interpolate(world, axes * -all, use);
  }
  return weights > 0 ? sum / weights : Vec3(0);
}

}  // namespace clipgs
