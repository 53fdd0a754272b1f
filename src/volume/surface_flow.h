#pragma once

#include <vector>

#include "volume/fine_grid.h"
#include "volume/transfer_function.h"
#include "volume/volume.h"

namespace clipgs {

/// The values of the fine grid's voxels: interpolated, and smoothed along their level sets where
/// what `transfer` shows meets what it does not (method.md §1, finer voxels).
std::vector<float> flow_surfaces(const Volume& volume, const TransferFunction& transfer,
                                 const FineGrid& grid);

}  // namespace clipgs
