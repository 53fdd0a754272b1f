#pragma once

#include <string>

#include "volume/stored_image.h"
#include "volume/volume.h"

namespace clipgs {

/// The stored image in RAS, its axes permuted and flipped to run closest to R, A, S; modality is
/// left unknown. `where` names it in errors. Throws Error for a grid that makes no sense: less than
/// two voxels along an axis, a corrupt spacing or origin, axes that are not perpendicular. A grid
/// that is stored mirrored (left-handed) becomes a right-handed one; left stays left.
Volume oriented(StoredImage stored, const std::string& where);

}  // namespace clipgs
