#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/parallel.h"
#include "volume/volume.h"
#include "volume/volume_size.h"

namespace clipgs {

/// The values of a volume as 16-bit codes in the layout that tracing wants: half the memory of
/// floats, and a border (the edge voxels repeated) so that interpolation needs no bounds checks.
///
///   value = low + code·step
class VoxelGrid {
 public:
  /// Codes cover [low, high]; values beyond are clamped to it.
  VoxelGrid(const Volume& volume, float low, float high);

  /// Trilinear code at a voxel position; every coordinate in [-1, dims].
  float sample(float x, float y, float z) const {
    // Positions are shifted to be positive so that truncation is floor.
    const float px = x + kLowBorder;
    const float py = y + kLowBorder;
    const float pz = z + kLowBorder;
    const int ix = static_cast<int>(px);
    const int iy = static_cast<int>(py);
    const int iz = static_cast<int>(pz);
    const std::uint16_t* v = codes_.data() + (static_cast<std::ptrdiff_t>(iz) * stride_z_ +
                                              static_cast<std::ptrdiff_t>(iy) * stride_y_ + ix);
    // Four rows of two neighbours along x, one row per lane.
    const Lanes<std::uint32_t> rows = {pair(v), pair(v + stride_y_), pair(v + stride_z_),
                                       pair(v + stride_z_ + stride_y_)};
    const auto left = __builtin_convertvector(Lanes<std::int32_t>(rows & 0xffffU), Lanes<float>);
    const auto right = __builtin_convertvector(Lanes<std::int32_t>(rows >> 16U), Lanes<float>);
    const Lanes<float> along_x = left + (px - static_cast<float>(ix)) * (right - left);
    const float fy = py - static_cast<float>(iy);
    const float fz = pz - static_cast<float>(iz);
    const float near = along_x[0] + fy * (along_x[1] - along_x[0]);
    const float far = along_x[2] + fy * (along_x[3] - along_x[2]);
    return near + fz * (far - near);
  }
  float sample(const Vec3& voxel) const { return sample(voxel.x, voxel.y, voxel.z); }

  /// Central differences over one voxel to either side, codes per voxel.
  Vec3 gradient(const Vec3& p) const {
    return 0.5f * Vec3(sample(p.x + 1, p.y, p.z) - sample(p.x - 1, p.y, p.z),
                       sample(p.x, p.y + 1, p.z) - sample(p.x, p.y - 1, p.z),
                       sample(p.x, p.y, p.z + 1) - sample(p.x, p.y, p.z - 1));
  }

  /// Code of voxel (x, y, z); each index in [-1, dims + 1].
  std::uint16_t code(int x, int y, int z) const {
    return codes_[static_cast<size_t>(z + kLowBorder) * stride_z_ +
                  static_cast<size_t>(y + kLowBorder) * stride_y_ +
                  static_cast<size_t>(x + kLowBorder)];
  }

  /// For kernels, whose 32 bits reach every voxel only from the middle: its place, counted from the
  /// border voxel (-1, -1, -1), and its code; and the distances of neighbours along y and z.
  std::ptrdiff_t middle() const { return middle(dims_); }
  const std::uint16_t* middle_code() const { return codes_.data() + middle(); }
  std::ptrdiff_t stride_y() const { return stride_y_; }
  std::ptrdiff_t stride_z() const { return stride_z_; }

  // Voxels that repeat the edge: x and x+1 of the cell that starts one voxel below the grid … two
  // voxels above it.
  static constexpr int kLowBorder = 1;
  static constexpr int kHighBorder = 2;
  /// Voxels along the axes, those of the border included.
  static IVec3 padded(const IVec3& dims) { return dims + kLowBorder + kHighBorder; }
  /// Of the codes of a volume, and of its LabelGrid.
  static std::uint64_t bytes(const VolumeSize& size) {
    static_assert(kLowBorder + kHighBorder == VolumeSize::kBorder);
    return size.padded_voxels() * (sizeof(std::uint16_t) + (size.labels ? 1 : 0));
  }
  static std::ptrdiff_t middle(const IVec3& dims) {
    const IVec3 size = padded(dims);
    return static_cast<std::ptrdiff_t>(size.x) * size.y * size.z / 2;
  }
  /// Calls visit(to, from) for every voxel of the layout: its place there, and the volume's voxel
  /// that it repeats.
  template <typename Visit>
  static void for_each_padded(const Volume& volume, const Visit& visit);

  const IVec3& dims() const { return dims_; }
  float value(float code) const { return low_ + code * step_; }
  float low() const { return low_; }
  float step() const { return step_; }

 private:
  template <typename T>
  using Lanes __attribute__((vector_size(16))) = T;

  static std::uint32_t pair(const std::uint16_t* v) {
    std::uint32_t two;
    std::memcpy(&two, v, sizeof two);
    return two;
  }

  IVec3 dims_;
  std::ptrdiff_t stride_y_ = 0;
  std::ptrdiff_t stride_z_ = 0;
  float low_ = 0;
  float step_ = 1;
  std::vector<std::uint16_t> codes_;
};

template <typename Visit>
void VoxelGrid::for_each_padded(const Volume& volume, const Visit& visit) {
  const IVec3 size = padded(volume.dims);
  parallel_for(static_cast<size_t>(size.z), 1, [&](size_t slice, size_t) {
    const int z = std::clamp(static_cast<int>(slice) - kLowBorder, 0, volume.dims.z - 1);
    size_t to = slice * static_cast<size_t>(size.y) * static_cast<size_t>(size.x);
    for (int py = 0; py < size.y; ++py) {
      const size_t row = volume.offset(0, std::clamp(py - kLowBorder, 0, volume.dims.y - 1), z);
      for (int px = 0; px < size.x; ++px, ++to) {
        const int x = std::clamp(px - kLowBorder, 0, volume.dims.x - 1);
        visit(to, row + static_cast<size_t>(x));
      }
    }
  });
}

}  // namespace clipgs
