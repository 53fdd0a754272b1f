#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/cut.h"
#include "core/geometry.h"

namespace clipgs {

// What the viewer shows, as numbers of the viewer's precision. RAS mm.

/// Where the camera stands: View, and `pan` moves what is looked at away from the sphere's centre,
/// `back` the camera away from that. The twin of View in web/src/model/view.ts.
struct ShownView {
  double azimuth = 0;
  double elevation = 0;
  double zoom = 1;
  glm::dvec3 pan{0};
  double back = 0;
};

/// A plane that keeps n·x ≥ offset, or the slab from there to `thickness` further.
struct ShownCut {
  glm::dvec3 normal{0, 0, 1};
  double offset = 0;
  std::optional<double> thickness;
};

/// Values from black to white of a slice, HU or as stored.
struct ShownWindow {
  double center = 0;
  double width = 1;
};

/// All that a link says of what is shown. The twin of Shown in web/src/model/flight.ts; its
/// beginning is that of the viewer's store.
struct Shown {
  ShownView view;
  std::vector<ShownCut> cuts;
  std::optional<ShownWindow> window;  ///< none: the case's own
  double grey = 0;
  double turn = 0;
  std::optional<glm::dvec3> lamp;
  double depth_cue = 0;
  std::string clip = "exact";
  std::string section = "volume";
  std::string openings = "cinematic";
  std::optional<std::string> rig;
  std::optional<std::string> background;
  bool body = true;
  bool faces = true;
  bool marks = true;
  bool handle = true;
};

/// What all cuts keep.
Cut cut_of(const Shown& shown);

/// The camera of a view of what lies in `sphere`, for a picture of that size, px.
Camera camera_of(const ShownView& view, const Sphere& sphere, int width, int height);

/// The same camera, and what it turns about, as a view of what lies in another sphere.
ShownView reframed(const ShownView& view, const Sphere& from, const Sphere& to);

}  // namespace clipgs
