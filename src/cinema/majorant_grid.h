#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "cinema/voxel_grid.h"
#include "volume/transfer_function.h"

namespace clipgs {

/// Macrocells of kCell³ voxels with the largest extinction that any point inside can have: the
/// cell's range of values (its border voxels included) through the transfer function. Beside it,
/// for each of the eight octants of directions, how many cells around are empty that way, so that a
/// ray leaps over air in a few steps.
class MajorantGrid {
 public:
  /// Side of the macrocells, voxels. Small cells bound tightly, so that tracking wastes few
  /// look-ups where a surface crosses a cell; smaller ones yet would outgrow the caches.
  static constexpr int kCell = 4;

  MajorantGrid(const VoxelGrid& grid, const TransferFunction& transfer);

  /// Walks the ray voxel = origin + t·direction for t in [t0, t1] (which must lie inside the
  /// grid) through the cells that are not empty, in order. visit(majorant, begin, end) returns true
  /// to stop; walk then returns true.
  template <typename Visit>
  bool walk(const Vec3& origin, const Vec3& direction, float t0, float t1,
            const Visit& visit) const {
    // Mirrored to run along +x, +y, +z, with strides that mirror the addresses back.
    std::array<float, 3> o;
    std::array<float, 3> d;
    std::array<float, 3> inverse;
    std::array<int, 3> i;
    std::array<std::ptrdiff_t, 3> stride;
    std::ptrdiff_t base = 0;
    int octant = 0;
    for (int k = 0; k < 3; ++k) {
      o[k] = origin[k] * (1.0f / kCell);
      d[k] = direction[k] * (1.0f / kCell);
      stride[k] = stride_[k];
      if (d[k] < 0) {
        o[k] = static_cast<float>(cells_[k]) - o[k];
        d[k] = -d[k];
        octant |= 1 << k;
        base += cells_[k] * stride_[k];
        stride[k] = -stride[k];
      } else {
        base += stride_[k];
      }
      inverse[k] = 1.0f / std::max(d[k], 1e-20f);
      i[k] = std::clamp(static_cast<int>(o[k] + d[k] * t0), 0, cells_[k] - 1);
    }
    const std::uint8_t* const leaps =
        leaps_.data() + static_cast<std::ptrdiff_t>(majorants_.size()) * octant + base;
    const float* const majorants = majorants_.data() + base;
    float t = t0;
    while (true) {
      const std::ptrdiff_t cell = i[0] * stride[0] + i[1] * stride[1] + i[2] * stride[2];
      const int empty = leaps[cell];
      const int step = std::max(empty, 1);
      const float tx = (static_cast<float>(i[0] + step) - o[0]) * inverse[0];
      const float ty = (static_cast<float>(i[1] + step) - o[1]) * inverse[1];
      const float tz = (static_cast<float>(i[2] + step) - o[2]) * inverse[2];
      const float yz = std::min(ty, tz);
      const float exit = std::min(tx, yz);
      if (empty == 0) {
        const float end = std::min(exit, t1);
        if (end > t && visit(majorants[cell], t, end)) {
          return true;
        }
      }
      if (exit >= t1) {
        return false;
      }
      t = std::max(t, exit);
      // The axis that was crossed moves by `step` whatever rounding says; no axis ever moves back,
      // so the walk ends. Cell index cells_ is the border, where rounding at the exit may lead.
      i[0] = next(i[0], o[0] + d[0] * t, tx <= exit ? step : 0, cells_[0]);
      i[1] = next(i[1], o[1] + d[1] * t, ty <= exit ? step : 0, cells_[1]);
      i[2] = next(i[2], o[2] + d[2] * t, tz <= exit ? step : 0, cells_[2]);
    }
  }

  const IVec3& cells() const { return cells_; }
  /// Majorant of a cell, 1/mm; each index in [0, cells).
  float majorant(int x, int y, int z) const {
    return majorants_[static_cast<size_t>((x + 1) * stride_[0] + (y + 1) * stride_[1] +
                                          (z + 1) * stride_[2])];
  }
  /// False if there is no matter anywhere between voxel (x, y, z) and its next neighbours, which
  /// are the eight voxels that interpolation at such a position sees; each index in [0, dims).
  bool has_matter(int x, int y, int z) const {
    const std::ptrdiff_t bit = z * mask_stride_z_ + y * mask_stride_y_ + x;
    return ((mask_[static_cast<size_t>(bit >> 6)] >> (bit & 63)) & 1U) != 0;
  }

  /// Voxel-space box of the cells that are not empty; empty if all are.
  const Box& occupied() const { return occupied_; }

 private:
  static int next(int index, float position, int step, int cells) {
    return std::min(std::max(index + step, static_cast<int>(position)), cells);
  }

  void find_majorants(const VoxelGrid& grid, const TransferFunction& transfer);
  void find_leaps();
  void find_mask(const VoxelGrid& grid, const TransferFunction& transfer);

  IVec3 cells_{0};
  std::array<std::ptrdiff_t, 3> stride_{};
  std::vector<float> majorants_;      // [cells.z + 2, cells.y + 2, cells.x + 2], empty border
  std::vector<std::uint8_t> leaps_;   // [8 octants] of the same
  std::ptrdiff_t mask_stride_y_ = 0;  // bits, a multiple of 64
  std::ptrdiff_t mask_stride_z_ = 0;
  std::vector<std::uint64_t> mask_;
  Box occupied_;
};

}  // namespace clipgs
