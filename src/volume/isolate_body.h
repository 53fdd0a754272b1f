#pragma once

#include "volume/volume.h"

namespace clipgs {

/// Sets to air (−1024 HU) what a CT shows beside the patient: table, cushions, cables, sheets, and
/// the noise of the air. The body is what stays thick when 6 mm are taken off every surface, with
/// what is attached to it and small (ears, nose, fingers) or bone. Arms beside the body and
/// instruments inside it stay. Returns the volume of matter (above −300 HU) removed, in ml.
///
/// Nothing changes, and 0 is returned, where there is no telling: no CT, no air in the picture, or
/// a thing whose walls are as thin as a table's (a hollow phantom).
double isolate_body(Volume& volume);

}  // namespace clipgs
