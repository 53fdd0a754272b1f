#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "core/geometry.h"
#include "core/random.h"
#include "volume/volume.h"

namespace clipgs {

/// A body whose surface is known: distance to it in mm, negative inside.
using SolidBody = std::function<float(const Vec3& ras)>;

inline SolidBody ball(float radius) {
  return [radius](const Vec3& p) { return glm::length(p) - radius; };
}

/// About the axis (0, sin 25°, cos 25°), so that no side of it lies in a slice.
inline SolidBody tilted_torus(float ring, float tube) {
  return [ring, tube](const Vec3& p) {
    const float angle = glm::radians(25.0f);
    const Vec3 axis(0, std::sin(angle), std::cos(angle));
    const float along = glm::dot(p, axis);
    const float across = glm::length(p - along * axis) - ring;
    return std::hypot(across, along) - tube;
  };
}

/// As high as a face that looks up: a forehead, two hollows, a nose and a chin on a bulge. The
/// distance is to first order, which is enough at the surface.
inline SolidBody face_like() {
  return [](const Vec3& p) {
    struct Bump {
      float x, y, width, length, height;
    };
    constexpr Bump kBumps[] = {
        {0, -5, 6, 10, 14}, {-16, 8, 8, 6, -7}, {16, 8, 8, 6, -7}, {0, -28, 12, 5, 5}};
    float height = 20 - (p.x * p.x + p.y * p.y) / 160;
    Vec2 slope(-p.x / 80, -p.y / 80);
    for (const Bump& bump : kBumps) {
      const Vec2 d((p.x - bump.x) / bump.width, (p.y - bump.y) / bump.length);
      const float here = bump.height * std::exp(-0.5f * glm::dot(d, d));
      height += here;
      slope -= here * d / Vec2(bump.width, bump.length);
    }
    return (p.z - height) / std::sqrt(1 + glm::dot(slope, slope));
  };
}

/// How a scanner samples a body.
struct TestScan {
  Vec3 spacing{1};       ///< mm; a voxel's value is the mean over it
  float half_side = 60;  ///< mm: the cube that is scanned, about the origin
  float noise = 0;       ///< HU, standard deviation
  float step = 1;        ///< HU between stored values: 1 of 12 bits, 16 of 8
  float inside = 40;     ///< HU of the body
  float outside = -1000;
};

/// A CT of the body.
inline Volume scan(const SolidBody& body, const TestScan& how) {
  constexpr float kSample = 0.4f;  // mm between the points that a voxel's mean is taken of, at most
  constexpr float kSoftness = 0.5f;  // mm, over which a point goes from inside to outside
  Volume volume;
  volume.spacing = how.spacing;
  volume.dims = IVec3(glm::ceil(2 * how.half_side / how.spacing));
  volume.origin = (Vec3(0.13f, 0.31f, 0.47f) - 0.5f * Vec3(volume.dims)) * how.spacing;
  volume.modality = Modality::kCt;
  const IVec3 samples(glm::ceil(how.spacing / kSample));
  std::vector<float> values(volume.voxels());
  Rng rng(1, 0);
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const Vec3 centre = volume.world_from_index(Vec3(x, y, z));
        const float reach = glm::length(how.spacing);
        float share = body(centre) < 0 ? 1 : 0;
        if (std::abs(body(centre)) < reach) {
          share = 0;
          for (int i = 0; i < samples.x * samples.y * samples.z; ++i) {
            const Vec3 at(i % samples.x, i / samples.x % samples.y, i / (samples.x * samples.y));
            const Vec3 off = ((at + 0.5f) / Vec3(samples) - 0.5f) * how.spacing;
            share += glm::clamp(0.5f - body(centre + off) / kSoftness, 0.0f, 1.0f);
          }
          share /= static_cast<float>(samples.x * samples.y * samples.z);
        }
        const float noise = how.noise > 0 ? how.noise * rng.normal() : 0;
        const float value = glm::mix(how.outside, how.inside, share) + noise;
        values[volume.offset(x, y, z)] = how.step * std::round(value / how.step);
      }
    }
  }
  volume.values = std::move(values);
  return volume;
}

}  // namespace clipgs
