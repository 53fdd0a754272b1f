#pragma once

#include "cinema/scene.h"
#include "core/geometry.h"

namespace clipgs {

/// The exposure under which what is bright in a scene, seen from all around and uncut, comes out at
/// about 80 % of the display's scale whatever lights it: for light rigs that a preset was not made
/// under. `sphere` bounds the visible matter.
float automatic_exposure(const CinemaScene& scene, const Sphere& sphere);

}  // namespace clipgs
