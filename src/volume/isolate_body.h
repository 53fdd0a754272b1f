#pragma once

#include "volume/volume.h"

namespace clipgs {

inline constexpr float kLeastMatter = -300;  ///< HU; foam of cushions is lighter, skin is not

/// What isolate_body() did.
struct Isolation {
  double removed = 0;   ///< ml of matter (kLeastMatter or more) set to air
  double foreign = 0;   ///< ml of parts that stay and hold no fat: a head holder, no limb
  bool unsure = false;  ///< what would have gone is more than a third of all matter: nothing went
};

/// Sets to air (−1024 HU) what a CT shows beside the patient: table, cushions, cables, sheets, and
/// the noise of the air. The body is what stays thick when 6 mm are taken off every surface, with
/// what is attached to it and small (ears, nose, fingers) or bone. What shells of up to 3.6 mm
/// enclose beside the body is not of it. Arms beside the body and instruments inside it stay.
/// Denser than 250 HU and bare (two fifths of its surface are within 1.5 mm of the air) is a cable,
/// a tube or a plate, and goes even where it touches the skin, with 2 mm around it that stand out
/// of the body; but of bones without flesh nothing goes for that.
///
/// Nothing changes, and nothing is counted, where there is no telling: no CT, no air in the
/// picture, or a thing whose walls are as thin as a table's (a hollow phantom).
Isolation isolate_body(Volume& volume);

}  // namespace clipgs
