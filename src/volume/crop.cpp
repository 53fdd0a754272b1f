#include "volume/crop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/parallel.h"
#include "volume/matter.h"

namespace clipgs {
namespace {

constexpr float kMargin = 5;  // mm

VoxelBox within_volume(const Volume& volume, const Vec3& low, const Vec3& high) {
  // Compared as floats: what a user asks for may lie beyond what an int holds.
  return {IVec3(glm::clamp(glm::ceil(low), Vec3(0), Vec3(volume.dims))),
          IVec3(glm::clamp(glm::floor(high), Vec3(-1), Vec3(volume.dims - 1)))};
}

/// `items` of `stride` a voxel.
template <typename T>
std::vector<T> part_of(const std::vector<T>& items, const Volume& volume, const VoxelBox& box,
                       size_t stride = 1) {
  const IVec3 dims = box.dims();
  const size_t row = stride * static_cast<size_t>(dims.x);
  std::vector<T> part(row * dims.y * dims.z);
  parallel_for(static_cast<size_t>(dims.z), 1, [&](size_t z, size_t) {
    for (int y = 0; y < dims.y; ++y) {
      const size_t from =
          stride * volume.offset(box.low.x, box.low.y + y, box.low.z + static_cast<int>(z));
      std::copy_n(items.begin() + static_cast<std::ptrdiff_t>(from), row,
                  part.begin() + static_cast<std::ptrdiff_t>((z * dims.y + y) * row));
    }
  });
  return part;
}

}  // namespace

VoxelBox voxels_within(const Volume& volume, const Box& mm) {
  Box index;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 pick(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    index.add(volume.index_from_world(glm::mix(mm.min, mm.max, pick)));
  }
  return within_volume(volume, index.min, index.max);
}

VoxelBox voxels_of_matter(const Volume& volume) {
  const IVec3 dims = volume.dims;
  const float least = least_matter(volume);
  const std::array<size_t, 3> strides = {1, static_cast<size_t>(dims.x),
                                         static_cast<size_t>(dims.x) * dims.y};
  const auto is_solid = [&](const IVec3& place, size_t at) {
    bool solid = volume.values[at] > least;
    for (int axis = 0; axis < 3 && solid; ++axis) {
      solid = (place[axis] == 0 || volume.values[at - strides[axis]] > least) &&
              (place[axis] == dims[axis] - 1 || volume.values[at + strides[axis]] > least);
    }
    return solid;
  };
  std::vector<Box> slices(dims.z);
  parallel_for(slices.size(), 1, [&](size_t z, size_t) {
    for (int y = 0; y < dims.y; ++y) {
      for (int x = 0; x < dims.x; ++x) {
        const IVec3 place(x, y, static_cast<int>(z));
        if (is_solid(place, volume.offset(place.x, place.y, place.z))) {
          slices[z].add(Vec3(place));
        }
      }
    }
  });
  Box all;
  for (const Box& slice : slices) {
    if (!slice.empty()) {
      all.add(slice.min);
      all.add(slice.max);
    }
  }
  if (all.empty()) {
    return {};
  }
  const Vec3 margin = kMargin / volume.spacing;
  return within_volume(volume, all.min - margin, all.max + margin);
}

void crop(Volume& volume, const VoxelBox& box) {
  const auto part = [&](const auto& items) { return part_of(items, volume, box); };
  volume.values.rearrange(part);
  if (!volume.scanned.empty()) {
    volume.scanned.rearrange(part);
  }
  if (!volume.rgb.empty()) {
    volume.rgb = part_of(volume.rgb, volume, box, 3);
  }
  if (!volume.labels.empty()) {
    volume.labels = part_of(volume.labels, volume, box);
  }
  volume.origin = volume.world_from_index(Vec3(box.low));
  volume.dims = box.dims();
}

}  // namespace clipgs
