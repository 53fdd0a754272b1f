#pragma once

#include <algorithm>

#include "core/geometry.h"

namespace clipgs {

/// Depth cueing: what is farther from the eye fades towards what lies behind the picture, as fog
/// has it (Levoy 1988, "Display of surfaces from volume data"). The twin of kept_of_depth() in
/// web/src/shaders/depth_cue.glsl.
struct DepthCue {
  float strength = 0;  ///< 0: nothing fades … 1: what is at `far` has gone
  float near = 0;      ///< mm from the eye: nothing fades up to here …
  float far = 1;       ///< … and nothing fades more from here on; above `near`

  /// From the nearest to the farthest that a sphere of what is visible reaches; RAS mm.
  static DepthCue over(const Sphere& sphere, const Vec3& eye, float how_much) {
    const float away = glm::length(sphere.center - eye);
    const float begin = std::max(0.0f, away - sphere.radius);
    return {how_much, begin, std::max(begin + 1e-3f, away + sphere.radius)};
  }

  /// The share that is left of something at this distance from the eye, mm.
  float kept(float distance) const {
    const float t = std::clamp((distance - near) / (far - near), 0.0f, 1.0f);
    return 1 - strength * t * t * (3 - 2 * t);
  }
};

}  // namespace clipgs
