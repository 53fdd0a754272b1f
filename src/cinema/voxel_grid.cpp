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
  const auto code_of = [&](float value) {
    const float code = (value - low_) / step_;
    return static_cast<std::uint16_t>(std::lround(std::clamp(code, 0.0f, kMaxCode)));
  };
  const VoxelValues& values = volume.values;
  if (values.packed()) {
    std::vector<std::uint16_t> ours(values.meaning().size());
    std::ranges::transform(values.meaning(), ours.begin(), code_of);
    for_each_padded(volume,
                    [&](size_t to, size_t from) { codes_[to] = ours[values.codes()[from]]; });
  } else {
    for_each_padded(volume,
                    [&](size_t to, size_t from) { codes_[to] = code_of(values.floats()[from]); });
  }
}

}  // namespace clipgs
