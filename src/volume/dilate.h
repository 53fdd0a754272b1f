#pragma once

#include "core/geometry.h"
#include "volume/bit_mask.h"

namespace clipgs {

/// What is within `radius` (mm) of the mask, whose voxels (x fastest) are `spacing` mm apart.
BitMask dilated(const IVec3& dims, const Vec3& spacing, const BitMask& mask, float radius);

/// What is farther than `radius` (mm) from what is not of the mask; beyond the picture all is.
BitMask eroded(const IVec3& dims, const Vec3& spacing, const BitMask& mask, float radius);

}  // namespace clipgs
