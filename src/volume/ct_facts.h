#pragma once

#include <string>

#include "volume/ct_contrast.h"
#include "volume/hints.h"
#include "volume/volume.h"

namespace clipgs {

/// What a coarse look at a CT in HU tells. Lengths are those of all slices across the patient's
/// long axis that show something, mm.
struct CtFacts {
  float height = 0;  ///< all slices
  float skull = 0;   ///< bone encloses most of the body, as the skull does the brain
  float lungs = 0;   ///< air fills a good part of the body
  float trunk = 0;   ///< the others that are as large as a trunk
  float bone = 0;    ///< share of the body, 0…1
  BodyRegion region = BodyRegion::kUnknown;
  Contrast contrast;
  std::string doubt;  ///< of the orientation: what lies where it should not; empty if nothing
};

/// Looks at means over blocks of about 2 mm. The volume is a CT that reaches down to air.
CtFacts ct_facts(const Volume& volume);

}  // namespace clipgs
