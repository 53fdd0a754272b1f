#pragma once

#include <string>

#include "core/camera.h"
#include "core/cut.h"
#include "core/image.h"
#include "section/section.h"
#include "volume/window.h"

namespace clipgs {

/// How a face looks: 0 cinematic … 1 grey, as radiologists read it: values through the window,
/// unlit (photographs: their own colours).
struct FaceStyle {
  float grey = 0;
  Window window;
  /// Where a grey face opens into a gap that the window shows black (of photographs, any gap):
  /// walls in their colours, walls of a clay that no value looks like, or the gap's values.
  enum class Openings { kCinematic, kNeutral, kValues };
  Openings openings = Openings::kCinematic;
};

/// Throws Error, naming the choices.
FaceStyle::Openings parse_grey_openings(const std::string& name);

class OpenedLight;

/// How cut faces are drawn.
struct FaceOptions {
  static constexpr int kMostRays = 8;
  int taps = 8;  ///< samples along a ray, from the face inwards
  int rays = 0;  ///< a pixel; 0: one, and kMostRays where that differs from a pixel beside it
  FaceStyle style = {};
  /// Of the section, under the cut; null: what lies behind a gap of a face is left to the splats.
  const OpenedLight* light = nullptr;
};

/// Draws the faces that `cut` exposes of what it keeps, as far as
/// `camera` sees them from the removed side: [height, width, 4], premultiplied display sRGB and
/// alpha, 0 elsewhere. A ray enters the kept region through one plane at most, so faces of several
/// planes cut each other without seams. Where the volume ends in matter there is a face too, with
/// planes or without. Shown is matter that begins at the face and, with `options.light`, the
/// walls that the cut lays open inside of the body; alpha tells how much of what lies behind is
/// seen.
Image draw_faces(const Section& section, const Camera& camera, const Cut& cut,
                 const FaceOptions& options = {});

/// How far from the camera each pixel's face is, mm, mean over its rays; 0 where there is none.
/// [height, width, 1].
Image face_distances(const Section& section, const Camera& camera, const Cut& cut);

/// The same as draw_faces() in double precision by many small steps, `rays` a pixel: what the fast
/// one is held to.
Image draw_faces_reference(const Section& section, const Camera& camera, const Cut& cut, int rays);

}  // namespace clipgs
