#pragma once

#include "volume/volume.h"

namespace clipgs {

/// Standard deviation of the noise in matter, value units: 1.4826 times the median magnitude of
/// what Immerkaer's mask (Computer Vision and Image Understanding 64, 1996) leaves of each slice,
/// which anatomy hardly touches. Of noise that a reconstruction has smoothed it is less than all
/// there is.
float estimate_noise(const Volume& volume);

/// Averages each voxel with those of the 124 around it (two along every axis) whose own
/// surroundings (3 x 3 x 3) are alike but for noise of `sigma` (non-local means: Buades, Coll and
/// Morel, CVPR 2005), so that edges stay. Values keep 16 bits.
void denoise_values(Volume& volume, float sigma);

}  // namespace clipgs
