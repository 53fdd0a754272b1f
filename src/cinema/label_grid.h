#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cinema/voxel_grid.h"
#include "volume/label_looks.h"

namespace clipgs {

/// The labels of a volume in VoxelGrid's layout, and how they look, for tracing.
class LabelGrid {
 public:
  /// `volume` has labels.
  LabelGrid(const Volume& volume, const LabelLooks& looks);

  /// The looks, one array a quantity, by index of the label.
  struct Looks {
    using Table = std::array<float, 256>;
    Table opacity{};
    Table has_albedo{};  ///< 1 if `albedo` replaces the transfer function's, else 0
    std::array<Table, 3> albedo{};
  };
  const Looks& looks() const { return looks_; }

  /// Opacity of voxel (x, y, z); each index in [-1, dims + 1].
  float opacity(int x, int y, int z) const {
    return looks_.opacity[indices_[static_cast<size_t>((z + VoxelGrid::kLowBorder) * stride_z_ +
                                                       (y + VoxelGrid::kLowBorder) * stride_y_ + x +
                                                       VoxelGrid::kLowBorder)]];
  }
  /// Trilinear: the mean over the labels that draws would choose at a voxel position in [-1, dims].
  float mean_opacity(const Vec3& voxel) const;

  /// Index of the label at VoxelGrid's middle(); strides are VoxelGrid's. Four bytes can be read at
  /// any voxel.
  const std::uint8_t* middle_label() const { return indices_.data() + middle_; }

 private:
  std::ptrdiff_t stride_y_;
  std::ptrdiff_t stride_z_;
  std::ptrdiff_t middle_;
  std::vector<std::uint8_t> indices_;
  Looks looks_;
};

}  // namespace clipgs
