#pragma once

#include "volume/bit_mask.h"
#include "volume/volume.h"

namespace clipgs {

/// Blurs the values of the voxels of a mask by a Gaussian of `deviation` (mm), about; what lies
/// around them stays as it is, and is blurred into them. An axis whose voxels are much longer than
/// that is hardly blurred.
void smooth_within(Volume& volume, const BitMask& mask, float deviation);

}  // namespace clipgs
