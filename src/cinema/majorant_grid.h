#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include "cinema/label_grid.h"
#include "cinema/voxel_grid.h"
#include "volume/gradient_opacity.h"
#include "volume/transfer_function.h"

namespace clipgs {

/// Macrocells of kCell³ voxels with the largest extinction that any point inside can have: the
/// cell's range of values (its border voxels included) through the transfer function, times the
/// largest opacity of its labels and the largest factor that its steepness allows. Where there is
/// nothing, the cells know how far the next matter is, so that a ray leaps over air in a few steps.
class MajorantGrid {
 public:
  /// Side of the macrocells, voxels. Small cells bound tightly, so that tracking wastes few
  /// look-ups where a surface crosses a cell; smaller ones yet would outgrow the caches.
  static constexpr int kCell = 2;

  /// `spacing` of the voxels in mm; `labels` may be null.
  MajorantGrid(const VoxelGrid& grid, const TransferFunction& transfer, const Vec3& spacing,
               const LabelGrid* labels = nullptr,
               const std::optional<GradientOpacity>& gradient_opacity = std::nullopt);

  /// Of the cells over so many voxels, while they are made.
  static std::uint64_t bytes(const IVec3& dims) {
    const IVec3 count = (dims + kCell - 1) / kCell;
    return static_cast<std::uint64_t>(count.x) * count.y * count.z *
           (sizeof(std::uint32_t) + sizeof(std::uint8_t));
  }

  /// Walks the ray voxel = origin + t·direction for t in [t0, t1] (which must lie inside the
  /// grid; t in mm) through the cells that are not empty, in order. visit(majorant, begin, end)
  /// returns true to stop; walk then returns true.
  template <typename Visit>
  bool walk(const Vec3& origin, const Vec3& direction, float t0, float t1,
            const Visit& visit) const {
    for (float t = t0; t < t1;) {
      const IVec3 cell = IVec3(glm::max(origin + t * direction, Vec3(0))) / kCell;
      const float bound = at(cell.x, cell.y, cell.z);
      const int hop = bound > 0 ? 1 : static_cast<int>(-bound);
      float exit = t1;
      for (int k = 0; k < 3; ++k) {
        const int side = direction[k] > 0 ? cell[k] + hop : cell[k] + 1 - hop;
        if (direction[k] != 0) {
          exit = std::min(exit, (static_cast<float>(side * kCell) - origin[k]) / direction[k]);
        }
      }
      const float end = std::min(std::max(exit, t) + nudge_, t1);
      if (bound > 0 && visit(bound, t, end)) {
        return true;
      }
      t = end;
    }
    return false;
  }

  /// For kernels that walk many rays at once.
  struct Cells {
    IVec3 count{0};
    std::int32_t stride_y = 0;
    std::int32_t stride_z = 0;
    /// The upper 16 bits are those of a float: a majorant in 1/mm, or if it is not positive, minus
    /// the distance to matter: so many cells are empty in every direction, this one included. Bit
    /// x + 2·y + 4·z is has_matter of the cell's voxel (x, y, z).
    std::vector<std::uint32_t> words;
  };
  static constexpr std::int32_t kBoundBits = -0x10000;
  const Cells& cells() const { return cells_; }
  /// How far rays go beyond the end of a cell, mm, to be sure to come to the next: a thousandth of
  /// a voxel, which is more than rounding takes from them.
  float nudge() const { return nudge_; }

  /// Majorant of a cell, 1/mm; each index in [0, cells().count).
  float majorant(int x, int y, int z) const { return std::max(0.0f, at(x, y, z)); }
  /// False if there is no matter anywhere between voxel (x, y, z) and its next neighbours, which
  /// are the eight voxels that interpolation at such a position sees; each index in [0, dims).
  bool has_matter(int x, int y, int z) const {
    return (cells_.words[index(x / kCell, y / kCell, z / kCell)] >> matter_bit(x, y, z) & 1U) != 0;
  }

  /// Voxel-space box of the cells that are not empty; empty if all are.
  const Box& occupied() const { return occupied_; }

 private:
  static int matter_bit(int x, int y, int z) { return x % 2 + 2 * (y % 2) + 4 * (z % 2); }
  size_t index(int x, int y, int z) const {
    return static_cast<size_t>(x) + static_cast<size_t>(y) * cells_.stride_y +
           static_cast<size_t>(z) * cells_.stride_z;
  }
  float at(int x, int y, int z) const {
    return std::bit_cast<float>(cells_.words[index(x, y, z)] &
                                static_cast<std::uint32_t>(kBoundBits));
  }

  class Thinning;
  void find_majorants(const VoxelGrid& grid, const TransferFunction& transfer,
                      const Thinning& thinning);
  void find_distances();
  void find_matter(const VoxelGrid& grid, const TransferFunction& transfer,
                   const Thinning& thinning);

  Cells cells_;
  float nudge_;
  Box occupied_;
};

}  // namespace clipgs
