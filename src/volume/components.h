#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/geometry.h"
#include "volume/bit_mask.h"

namespace clipgs {

/// The voxel with that offset, x fastest.
inline IVec3 place_of(const IVec3& dims, size_t offset) {
  const auto width = static_cast<size_t>(dims.x);
  const auto height = static_cast<size_t>(dims.y);
  return IVec3(offset % width, offset / width % height, offset / (width * height));
}

/// Takes the component (connected by faces) of voxel `seed` off the mask, and calls visit(offset)
/// for each of its voxels. Only the front of the flood is held in memory.
template <typename Visit>
void take_component(const IVec3& dims, size_t seed, BitMask& mask, const Visit& visit) {
  const std::array<std::ptrdiff_t, 3> strides = {1, dims.x, std::ptrdiff_t{dims.x} * dims.y};
  std::vector<size_t> front{seed};
  std::vector<size_t> next;
  mask.clear(seed);
  for (; !front.empty(); front.swap(next), next.clear()) {
    for (const size_t at : front) {
      visit(at);
      const IVec3 place = place_of(dims, at);
      for (int axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          const int there = place[axis] + step;
          const size_t neighbour = at + static_cast<size_t>(step * strides[axis]);
          if (there >= 0 && there < dims[axis] && mask[neighbour]) {
            mask.clear(neighbour);
            next.push_back(neighbour);
          }
        }
      }
    }
  }
}

/// Calls use(seed) for a voxel of each component of the mask; use takes the component off it.
template <typename Use>
void for_each_component(BitMask& mask, const Use& use) {
  for (size_t seed = mask.next(0); seed < mask.size(); seed = mask.next(seed)) {
    use(seed);
  }
}

}  // namespace clipgs
