#pragma once

#include "volume/volume.h"

namespace clipgs {

inline constexpr float kLeastMatter = -300;  ///< HU; foam of cushions is lighter, skin is not

struct Isolation {
  double removed = 0;   ///< ml of matter (kLeastMatter or more) set to air
  double foreign = 0;   ///< ml of parts that stay and hold no fat: a head holder, no limb
  bool unsure = false;  ///< what would have gone is more than a third of all matter: nothing went
};

/// Sets to air (−1024 HU) what a CT shows beside the patient: table, cushions, cables, sheets, and
/// the noise of the air. The body is what stays thick when 6 mm are taken off every surface, with
/// what is attached to it and small (ears, nose, fingers) or bone. Arms beside the body and
/// instruments inside it stay.
///
/// Nothing changes, and nothing is counted, where there is no telling: no CT, no air in the
/// picture, or a thing whose walls are as thin as a table's (a hollow phantom).
Isolation isolate_body(Volume& volume);

}  // namespace clipgs
