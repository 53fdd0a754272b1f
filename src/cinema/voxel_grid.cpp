#include "cinema/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clipgs {

VoxelGrid::VoxelGrid(const Volume& volume, float low, float high) : dims_(volume.dims), low_(low) {
  constexpr float kMaxCode = std::numeric_limits<std::uint16_t>::max();
  step_ = high > low ? (high - low) / kMaxCode : 1.0f;
  const IVec3 size = padded(dims_);
  stride_y_ = size.x;
  stride_z_ = static_cast<std::ptrdiff_t>(size.x) * size.y;
  codes_.resize(static_cast<size_t>(stride_z_) * static_cast<size_t>(size.z));
  for_each_padded(volume, [&](size_t to, size_t from) {
    const float code = (volume.values[from] - low_) / step_;
    codes_[to] = static_cast<std::uint16_t>(std::lround(std::clamp(code, 0.0f, kMaxCode)));
  });
}

}  // namespace clipgs
