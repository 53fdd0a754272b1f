#pragma once

#include <cstddef>
#include <vector>

#include "volume/volume.h"

namespace clipgs {

/// Means over blocks of about 2 mm along each axis (or single voxels, where they are
/// larger), x fastest: less noise and fewer voxels, and every wall of bone is still there.
struct CoarseVolume {
  IVec3 dims{0};
  Vec3 spacing{1};  ///< mm
  std::vector<float> values;

  size_t slice() const { return static_cast<size_t>(dims.x) * dims.y; }
  float ml() const { return spacing.x * spacing.y * spacing.z / 1000; }  ///< of a block
  IVec3 place(size_t offset) const {
    return IVec3(offset % dims.x, offset / dims.x % dims.y, offset / slice());
  }
  size_t offset(const IVec3& p) const {
    return (static_cast<size_t>(p.z) * dims.y + p.y) * dims.x + p.x;
  }
  bool holds(const IVec3& p) const {
    return glm::all(glm::greaterThanEqual(p, IVec3(0))) && glm::all(glm::lessThan(p, dims));
  }
};

CoarseVolume coarse_volume(const Volume& volume);

}  // namespace clipgs
