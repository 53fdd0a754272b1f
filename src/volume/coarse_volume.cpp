#include "volume/coarse_volume.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace clipgs {

CoarseVolume coarse_volume(const Volume& volume) {
  constexpr float kBlock = 2;  // mm
  CoarseVolume coarse;
  IVec3 factor;
  for (int axis = 0; axis < 3; ++axis) {
    factor[axis] = std::clamp(static_cast<int>(std::lround(kBlock / volume.spacing[axis])), 1,
                              volume.dims[axis]);
  }
  coarse.dims = (volume.dims + factor - 1) / factor;
  coarse.spacing = volume.spacing * Vec3(factor);
  coarse.values.resize(coarse.slice() * coarse.dims.z);
  std::vector<size_t> columns;  // of blocks, by voxel
  columns.reserve(static_cast<size_t>(volume.dims.x));
  for (int x = 0; x < volume.dims.x; ++x) {
    columns.push_back(static_cast<size_t>(x / factor.x));
  }
  parallel_for(static_cast<size_t>(coarse.dims.z), 1, [&](size_t slice, size_t) {
    const auto first = static_cast<int>(slice) * factor.z;
    const int last = std::min(first + factor.z, volume.dims.z);
    std::vector<float> sums(coarse.slice());
    for (int z = first; z < last; ++z) {
      for (int y = 0; y < volume.dims.y; ++y) {
        const size_t from = volume.offset(0, y, z);
        const size_t to = static_cast<size_t>(y / factor.y) * coarse.dims.x;
        for (size_t x = 0; x < columns.size(); ++x) {
          sums[to + columns[x]] += volume.values[from + x];
        }
      }
    }
    for (size_t i = 0; i < sums.size(); ++i) {
      const IVec3 low = coarse.place(slice * sums.size() + i) * factor;
      const IVec3 voxels = glm::min(low + factor, volume.dims) - low;
      coarse.values[slice * sums.size() + i] =
          sums[i] / static_cast<float>(voxels.x * voxels.y * voxels.z);
    }
  });
  return coarse;
}

}  // namespace clipgs
