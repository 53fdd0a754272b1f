#pragma once

#include "core/image.h"
#include "volume/volume.h"

namespace clipgs {

/// Where a head lies, with what reaches as far beside it, RAS mm: around the matter of the top 15
/// cm, and 26 cm high. Empty if there is no matter.
Box box_of_head(const Volume& volume);

/// The surface of the matter in a box from the front and, beside that, from the patient's right, in
/// grey. RGB.
Image draw_head(const Volume& volume, const Box& box);

/// Two pictures of draw_head() beside one another. RGB. Throws Error.
Image draw_before_and_after(const Image& before, const Image& after);

}  // namespace clipgs
