#pragma once

#include <vector>

#include "core/geometry.h"
#include "volume/bit_mask.h"

namespace clipgs {

/// How far the middle of each voxel (x fastest, `spacing` mm apart) lies from that of the nearest
/// voxel of the mask, mm; `most` where that is farther.
std::vector<float> distances_to(const IVec3& dims, const Vec3& spacing, const BitMask& mask,
                                float most);

}  // namespace clipgs
