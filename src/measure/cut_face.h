#pragma once

#include <cstddef>
#include <optional>

#include "core/camera.h"
#include "core/image.h"

namespace clipgs {

// What XClipGS measures a cut by (arXiv 2608.07760; defined by its public scripts, cutplane_metrics
// and cutplane_cde): faces seen from before, and their edges seen along the plane, 1.5° from the
// kept side. Pictures are in display sRGB over black, brightness is a pixel's largest channel,
// luminance the mean of all three. Distances are in pixels, whatever the picture's size; theirs are
// of 1600 × 1600.

/// Pixels that a cut changes: the luminance by more than 0.04.
struct CutChange {
  size_t missed = 0;   ///< in the truth alone: what was left standing …
  size_t extra = 0;    ///< … and in the picture alone
  size_t changed = 0;  ///< in the truth

  void add(const CutChange& other);
  /// (missed + extra) / changed, in units of 10⁻²; empty where nothing changed.
  std::optional<double> percent() const;
};

/// Sums over pictures.
struct CutFace {
  double ssim_sum = 0;   ///< of faces: SSIM of luminance, one window over what the truth shows
  size_t faces = 0;      ///< pictures that have one
  double leaked = 0;     ///< brightness at edges, of what the truth does not show, beyond the plane
  double near_edge = 0;  ///< … and of all that is shown within 60 px of it
  CutChange edge;        ///< within 12 px of it
  CutChange face;

  void add(const CutFace& other);
  std::optional<double> ssim() const;
  std::optional<double> leak_percent() const;  ///< leaked / near_edge, 10⁻²
};

/// A view of a cut: pictures of one size, RGBA with straight alpha or RGB.
struct CutView {
  const Image& truth;
  const Image& uncut_truth;
  const Image& picture;
  const Image& uncut_picture;
  Camera camera;
  Plane plane;
};

/// How far the middles of pixels lie from where the plane meets the picture, px: [h, w, 1],
/// negative where it keeps. A plane that a camera does not lie in has no line there: as in XClipGS,
/// that whose plane through the camera is nearest to it, by least squares of the normal and the
/// offset in radii of `sphere`, from its middle. Zero everywhere for a plane that is seen straight.
Image distance_from_edge(const Camera& camera, const Plane& plane, const Sphere& sphere);

/// Of one view: from the removed side, of a face; from the kept side, of an edge. `sphere`: around
/// the visible matter. Throws Error when the sizes differ.
CutFace cut_face(const CutView& view, const Sphere& sphere);

}  // namespace clipgs
