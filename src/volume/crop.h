#pragma once

#include "volume/volume.h"

namespace clipgs {

/// Voxels of a volume from `low` to `high`, both included; empty if high < low along an axis.
struct VoxelBox {
  IVec3 low{0};
  IVec3 high{-1};

  IVec3 dims() const { return glm::max(high - low + 1, IVec3(0)); }
};

/// The voxels within a box in RAS mm. Where the grid lies askew in the patient, all of the grid's
/// own box around it.
VoxelBox voxels_within(const Volume& volume, const Box& mm);

/// The voxels around all that is neither air nor background (least_matter()), with a margin of
/// 5 mm. A voxel counts whose six neighbours are matter as well: noise does not. Empty where
/// nothing is.
VoxelBox voxels_of_matter(const Volume& volume);

/// Leaves what lies in the box, which must hold at least two voxels along every axis and lie in
/// the volume. What is left stays where it is in the patient.
void crop(Volume& volume, const VoxelBox& box);

}  // namespace clipgs
