#include "volume/phantom.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "volume/phantom_body.h"

namespace clipgs {
namespace {

Volume air(const IVec3& dims, float spacing) {
  Volume volume;
  volume.dims = dims;
  volume.spacing = Vec3(spacing);
  volume.origin = -0.5f * Vec3(dims - 1) * spacing;
  volume.modality = Modality::kCt;
  volume.values.assign(volume.voxels(), -1000.0f);
  return volume;
}

}  // namespace

Volume make_phantom(int size, std::uint64_t seed) {
  if (size < 16 || size > 1024) {
    throw Error("phantom: size {} must lie in 16..1024", size);
  }
  const Vec3 extent(348, 240, 400);  // mm
  const float spacing = extent.z / static_cast<float>(size);
  Volume volume = air(IVec3(glm::round(extent / spacing)), spacing);

  phantom::Painter painter(volume, seed);
  phantom::paint_wall(painter);
  phantom::paint_organs(painter);
  phantom::paint_chest(painter, seed);
  phantom::paint_vessels(painter, seed);
  phantom::paint_skeleton(painter);

  // Whole HU, as scanners store them: files stay small and give back the same values.
  for (float& value : volume.values) {
    value = std::round(value);
  }
  return volume;
}

Volume make_ball(int size, float radius_mm, float inside, float outside) {
  if (size < 2) {
    throw Error("ball: size {} must be at least 2", size);
  }
  Volume volume = air(IVec3(size), 1);
  for (int z = 0; z < size; ++z) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const float d = glm::length(volume.world_from_index(Vec3(x, y, z))) - radius_mm;
        volume.values[volume.offset(x, y, z)] =
            glm::mix(outside, inside, std::clamp(0.5f - d, 0.0f, 1.0f));
      }
    }
  }
  return volume;
}

}  // namespace clipgs
