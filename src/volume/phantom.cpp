#include "volume/phantom.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

/// Share of a voxel of size `voxel` that a surface at signed distance `d` leaves inside.
float coverage(float d, float voxel) { return std::clamp(0.5f - d / voxel, 0.0f, 1.0f); }

float ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 q = (p - center) / radii;
  const float k = glm::length(q);
  return (k - 1) * std::min({radii.x, radii.y, radii.z});
}

float torso(const Vec3& p, float inset) {
  return ellipsoid(Vec3(p.x, p.y, 0), Vec3(0), Vec3(165 - inset, 110 - inset, 1000));
}

float hu_at(const Vec3& p, float voxel) {
  float hu = -1000;
  const auto paint = [&](float d, float value) { hu = glm::mix(hu, value, coverage(d, voxel)); };
  paint(torso(p, 0), 40);
  paint(torso(p, 3), -100);
  paint(torso(p, 18), 50);
  paint(torso(p, 32), -90);
  for (const float side : {-1.0f, 1.0f}) {
    paint(ellipsoid(p, {side * 70, 0, 70}, {50, 62, 95}), -800);
    paint(ellipsoid(p, {side * 65, -35, -70}, {24, 22, 45}), 110);
  }
  paint(ellipsoid(p, {50, 10, -20}, {70, 60, 45}), 70);
  paint(ellipsoid(p, {-10, 25, 50}, {45, 40, 50}), 80);
  paint(ellipsoid(Vec3(p.x, p.y, 0), {0, -62, 0}, {22, 18, 1000}), 1000);
  paint(ellipsoid(Vec3(p.x, p.y, 0), {0, -62, 0}, {19, 15, 1000}), 220);
  return hu;
}

}  // namespace

Volume make_phantom(int size, std::uint64_t seed) {
  if (size < 16 || size > 1024) {
    throw Error("phantom: size {} must lie in 16..1024", size);
  }
  static_cast<void>(seed);
  const Vec3 extent(360, 240, 400);
  Volume volume;
  volume.spacing = Vec3(extent.z / static_cast<float>(size));
  volume.dims = IVec3(glm::round(extent / volume.spacing));
  volume.origin = -0.5f * Vec3(volume.dims - 1) * volume.spacing;
  volume.modality = Modality::kCt;
  volume.values.resize(volume.voxels());
  parallel_for(static_cast<size_t>(volume.dims.z), 1, [&](size_t begin, size_t end) {
    for (auto z = static_cast<int>(begin); z < static_cast<int>(end); ++z) {
      for (int y = 0; y < volume.dims.y; ++y) {
        for (int x = 0; x < volume.dims.x; ++x) {
          volume.values[volume.offset(x, y, z)] =
              hu_at(volume.world_from_index(Vec3(x, y, z)), volume.spacing.x);
        }
      }
    }
  });
  return volume;
}

Volume make_ball(int size, float radius_mm, float inside, float outside) {
  Volume volume;
  volume.dims = IVec3(size);
  volume.origin = Vec3(-0.5f * static_cast<float>(size - 1));
  volume.modality = Modality::kCt;
  volume.values.resize(volume.voxels());
  for (int z = 0; z < size; ++z) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const float d = glm::length(volume.world_from_index(Vec3(x, y, z))) - radius_mm;
        volume.values[volume.offset(x, y, z)] = glm::mix(outside, inside, coverage(d, 1));
      }
    }
  }
  return volume;
}

}  // namespace clipgs
