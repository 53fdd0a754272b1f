#pragma once

#include "core/camera.h"
#include "core/cut.h"
#include "core/depth_cue.h"
#include "core/image.h"
#include "section/openings.h"
#include "section/section.h"

namespace clipgs {

/// What `camera` sees of the matter that `cut` keeps, drawn from the section alone and lit by
/// `light`, the cut's: [height, width, 4], straight display sRGB, and as alpha the share of `rays`
/// a pixel that meet matter otherwise than through a face, which draw_faces() shows. Colours fade
/// to black with `cue`, as those of splats do. Sharp at any size, but what light does below the
/// surface, and whatever else splats have learnt, is not in it (method.md §8).
Image draw_surface(const Section& section, const Camera& camera, const Cut& cut,
                   const OpenedLight& light, const DepthCue& cue = {}, int rays = 4);

}  // namespace clipgs
