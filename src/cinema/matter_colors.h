#pragma once

#include <cstdint>
#include <vector>

#include "volume/transfer_function.h"
#include "volume/volume.h"

namespace clipgs {

/// The colours of what `transfer` shows of photographs, for interpolation: [nz, ny, nx, 3] u8,
/// sRGB. Matter keeps its own, but a voxel beside empty ones is half black: it takes the mean of
/// those neighbours that touch nothing empty, if they are brighter, or of those that took theirs
/// so. Empty voxels beside matter take the mean of it, so that no black is mixed into surfaces.
/// Empty if the volume has no colours.
std::vector<std::uint8_t> matter_colors(const Volume& volume, const TransferFunction& transfer);

}  // namespace clipgs
