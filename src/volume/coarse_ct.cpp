#include "volume/coarse_ct.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace clipgs {

CoarseCt coarse_ct(const Volume& volume) {
  constexpr float kBlock = 2;  // mm
  CoarseCt coarse;
  IVec3 factor;
  for (int axis = 0; axis < 3; ++axis) {
    factor[axis] = std::clamp(static_cast<int>(std::lround(kBlock / volume.spacing[axis])), 1,
                              volume.dims[axis]);
  }
  coarse.dims = (volume.dims + factor - 1) / factor;
  coarse.spacing = volume.spacing * Vec3(factor);
  coarse.hu.resize(coarse.slice() * coarse.dims.z);
  parallel_for(static_cast<size_t>(coarse.dims.z), 1, [&](size_t slice, size_t) {
    const auto first = static_cast<int>(slice) * factor.z;
    const int last = std::min(first + factor.z, volume.dims.z);
    std::vector<float> sums(coarse.slice());
    std::vector<int> counts(coarse.slice());
    for (int z = first; z < last; ++z) {
      for (int y = 0; y < volume.dims.y; ++y) {
        const size_t from = volume.offset(0, y, z);
        const size_t to = static_cast<size_t>(y / factor.y) * coarse.dims.x;
        for (int x = 0; x < volume.dims.x; ++x) {
          sums[to + x / factor.x] += volume.values[from + x];
          ++counts[to + x / factor.x];
        }
      }
    }
    for (size_t i = 0; i < sums.size(); ++i) {
      coarse.hu[slice * sums.size() + i] = sums[i] / static_cast<float>(counts[i]);
    }
  });
  return coarse;
}

}  // namespace clipgs
