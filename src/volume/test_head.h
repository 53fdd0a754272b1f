#pragma once

#include <cmath>

#include "core/random.h"
#include "volume/volume.h"

namespace clipgs {

/// A made-up head, mm to its right, front and top from the middle of its brain.
enum class HeadPart { kAir, kScalp, kFlesh, kSkull, kBrain, kEye, kNose };

inline bool in_ellipsoid(const Vec3& p, const Vec3& middle, const Vec3& radii) {
  return glm::length((p - middle) / radii) < 1;
}

inline constexpr Vec3 kBrainRadii(66, 85, 62);

/// A brain in its skull and scalp, on a neck, with a face that has eyes, a nose and a jaw.
inline HeadPart head_part(const Vec3& p) {
  const Vec3 eye(std::abs(p.x) - 32, p.y - 78, p.z + 52);
  const Vec2 spine(p.x, p.y + 25);
  if (in_ellipsoid(p, Vec3(0), kBrainRadii) || (glm::length(spine) < 8 && p.z < 0 && p.z > -75)) {
    return HeadPart::kBrain;
  }
  if (in_ellipsoid(p, Vec3(0), kBrainRadii + 7.0f) || (glm::length(spine) < 20 && p.z < -50)) {
    return HeadPart::kSkull;
  }
  if (glm::length(eye) < 12) {
    return HeadPart::kEye;
  }
  if (in_ellipsoid(p, {0, 100, -72}, {11, 16, 16})) {
    return HeadPart::kNose;
  }
  const bool jaw =
      in_ellipsoid(p, {0, 50, -110}, {50, 50, 22}) && !in_ellipsoid(p, {0, 40, -110}, {38, 42, 40});
  if (jaw) {
    return HeadPart::kSkull;
  }
  if (in_ellipsoid(p, {0, 45, -70}, {62, 52, 78}) || (glm::length(spine) < 58 && p.z < -40)) {
    return HeadPart::kFlesh;
  }
  return in_ellipsoid(p, Vec3(0), kBrainRadii + 13.0f) ? HeadPart::kScalp : HeadPart::kAir;
}

inline float ct_of_head(HeadPart part) {
  constexpr float kHu[] = {-1000, -80, 50, 900, 35, 10, 30};
  return kHu[static_cast<int>(part)];
}

inline float mr_of_head(HeadPart part) {
  constexpr float kSignal[] = {4, 150, 80, 12, 100, 40, 90};
  return kSignal[static_cast<int>(part)];
}

/// What a scanner makes of that head in cubes of `spacing` mm, with noise of a tenth of what is
/// between air and brain from end to end. `turn`: of the head in the picture.
inline Volume scanned_head(Modality modality, const Mat3& turn = Mat3(1), float spacing = 2.5f) {
  Volume volume;
  volume.spacing = Vec3(spacing);
  volume.dims = IVec3(Vec3(200, 250, 260) / spacing);
  volume.origin = {-100, -120, -160};
  volume.modality = modality;
  const bool ct = modality == Modality::kCt;
  std::vector<float> values;
  values.reserve(volume.voxels());
  Rng rng(1);
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const HeadPart part = head_part(volume.world_from_index(Vec3(x, y, z)) * turn);
        const float noise = (ct ? 60.0f : 6.0f) * (rng.uniform() - 0.5f);
        values.push_back(
            std::max((ct ? ct_of_head(part) : mr_of_head(part)) + noise, ct ? -1024.0f : 0.0f));
      }
    }
  }
  volume.values = std::move(values);
  return volume;
}

}  // namespace clipgs
