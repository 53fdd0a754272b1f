#pragma once

#include "volume/volume.h"

namespace clipgs {

inline constexpr float kMetal = 2500;  ///< HU; no bone is as dense, enamel seldom

/// What soften_metal() met.
struct MetalSoftening {
  double metal_ml = 0;  ///< what is at least as dense as was asked for, in the slices below
  int slices = 0;       ///< that hold at least 5 mm² of it
};

/// Softens the streaks that metal (`least` HU or more) casts over the axial slices of a CT: every
/// other voxel of such a slice becomes the mean of those within 5 mm of it that are not too unlike
/// it (Tukey's weights up to 600 HU), the less of it and the more alike the farther it is from the
/// metal, and nothing of it from 60 mm on. Changes pictures, and mends no data: what is hidden by a
/// streak stays hidden.
MetalSoftening soften_metal(Volume& volume, float least);

}  // namespace clipgs
