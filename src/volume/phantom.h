#pragma once

#include <cstdint>

#include "volume/volume.h"

namespace clipgs {

/// A procedural torso in HU: skin, fat, muscle, ribs and spine with marrow, aorta and branching
/// vessels, lungs with airways, heart, liver, kidneys, soft texture. `size` is the number of voxels
/// along the longest axis; edges are as blurred as a scanner's; the same seed gives the same bytes.
Volume make_phantom(int size = 256, std::uint64_t seed = 1);

/// A ball of `inside` in `outside`, the value a known function of the distance from the centre: for
/// tests that need analytic truth. Spacing 1 mm, `size`³ voxels, centred on the world's origin.
Volume make_ball(int size, float radius_mm, float inside, float outside);

}  // namespace clipgs
