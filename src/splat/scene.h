#pragma once

#include <string>

#include "core/geometry.h"
#include "splat/gaussians.h"

namespace clipgs {

/// An explicit Gaussian scene with what is needed to show and cut it; what a case file holds.
struct Scene {
  Gaussians gaussians;  ///< world space (RAS mm)
  Sphere sphere;        ///< bounding sphere of the visible matter: frames the camera
  Box bounds;           ///< bounding box of the visible matter
  Vec3 axis{0, 0, 1};   ///< the uniaxial cut's normal n₀
  Vec2 extent{0};       ///< interval of axis·x over the visible matter, mm
  std::string title;    ///< chosen by the user or the preset, never read from the input
  std::string preset;   ///< name of the preset
  std::string created;  ///< ISO 8601 date, or empty
};

}  // namespace clipgs
