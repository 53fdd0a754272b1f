#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.h"
#include "volume/bit_mask.h"

namespace clipgs {

/// Which 0s of a mask (one byte a voxel, x fastest) a flood reaches that starts at the borders of
/// each slice along z and passes from 0 to 0 beside it in the slice: 1 there, 0 elsewhere.
std::vector<std::uint8_t> flood_slices(const IVec3& dims, const std::vector<std::uint8_t>& mask);
/// The same of bits.
BitMask flood_slices(const IVec3& dims, const BitMask& mask);

}  // namespace clipgs
