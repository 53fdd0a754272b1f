#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/cut.h"
#include "core/image.h"
#include "section/faces.h"
#include "section/section.h"

namespace clipgs {

/// "63 ± 2 HU" at a point (RAS mm) of the section; "outside" where there is no body. The unit is
/// there for CT only.
std::string value_text(const Section& section, const Vec3& point);

/// Writes on a picture (straight RGBA) what a reader of a face needs: the letters of the patient's
/// directions at the edges, a bar of whole millimetres that is true at the face's middle, the
/// window, and the values at `pins` (RAS mm). Where `cut` is empty the bar is true at the section's
/// middle.
void annotate(Image& picture, const Section& section, const Camera& camera, const Cut& cut,
              const FaceStyle& style, std::span<const Vec3> pins);

/// "R", "LA", "SPR": where a direction (RAS) leads, the strongest letter first; weak ones are left
/// out.
std::string direction_letters(const Vec3& direction);

}  // namespace clipgs
