#pragma once

#include <span>

#include "core/camera.h"
#include "core/image.h"
#include "section/section.h"

namespace clipgs {

struct FaceOptions {
  int taps = 8;     ///< samples along a ray, from the face inwards
  int samples = 0;  ///< rays a pixel along either side; 0: as many as the section has detail for
};

/// Draws the faces that `planes` expose of what lies on the kept side of all of them, as far as
/// `camera` sees them from the removed side: [height, width, 4], premultiplied display sRGB and
/// alpha, 0 elsewhere. A ray enters the kept region through one plane at most, so faces of several
/// planes cut each other without seams. Shown is matter that begins at the face; alpha tells how
/// much of what lies behind is seen.
Image draw_faces(const Section& section, const Camera& camera, std::span<const Plane> planes,
                 const FaceOptions& options = {});

/// The same in double precision by many small steps: what the fast one is held to.
Image draw_faces_reference(const Section& section, const Camera& camera,
                           std::span<const Plane> planes, int samples);

/// Puts `faces` in front of `picture`, both [h, w, 4], premultiplied.
void put_in_front(const Image& faces, Image& picture);

}  // namespace clipgs
