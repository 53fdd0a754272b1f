#pragma once

#include "volume/volume.h"

namespace clipgs {

/// Whether a volume whose values mean nothing known looks as if a scanner's table lay beside the
/// body. Air and tissue are the two classes of Otsu's threshold (Otsu 1979), to which HU are given;
/// of what isolate_body() would then take off at least 5 ml, and most of it, is a prism along the
/// patient: its cross-section is the same in nine of ten slices, and at least 50 mm wide or deep.
/// Looks at no more than 128 voxels along each axis, the brightest of those between.
bool shows_table(const Volume& volume);

}  // namespace clipgs
