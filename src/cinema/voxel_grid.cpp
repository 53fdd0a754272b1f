#include "cinema/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace clipgs {

VoxelGrid::VoxelGrid(const Volume& volume, float low, float high) : dims_(volume.dims), low_(low) {
  constexpr float kMaxCode = std::numeric_limits<std::uint16_t>::max();
  step_ = high > low ? (high - low) / kMaxCode : 1.0f;
  const IVec3 padded = dims_ + kLowBorder + kHighBorder;
  stride_y_ = padded.x;
  stride_z_ = static_cast<std::ptrdiff_t>(padded.x) * padded.y;
  codes_.resize(static_cast<size_t>(stride_z_) * static_cast<size_t>(padded.z));

  parallel_for(static_cast<size_t>(padded.z), 1, [&](size_t begin, size_t) {
    const int pz = static_cast<int>(begin);
    const int z = std::clamp(pz - kLowBorder, 0, dims_.z - 1);
    for (int py = 0; py < padded.y; ++py) {
      const int y = std::clamp(py - kLowBorder, 0, dims_.y - 1);
      const float* row = &volume.values[volume.offset(0, y, z)];
      std::uint16_t* out = &codes_[static_cast<size_t>(pz * stride_z_ + py * stride_y_)];
      for (int px = 0; px < padded.x; ++px) {
        const float value = row[std::clamp(px - kLowBorder, 0, dims_.x - 1)];
        const float code = (value - low_) / step_;
        out[px] = static_cast<std::uint16_t>(std::lround(std::clamp(code, 0.0f, kMaxCode)));
      }
    }
  });
}

}  // namespace clipgs
