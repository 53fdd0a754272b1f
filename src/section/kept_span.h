#pragma once

#include <span>

#include "core/ray_span.h"
#include "section/section.h"

namespace clipgs {

/// The part of a ray, mm from the eye, along a unit direction, that planes and the section's box
/// leave. `origin` and `stride` are the eye and the voxels per mm, section's index.
template <typename T, typename V>
RaySpan<T> kept_span(const Section& section, std::span<const Plane> planes, const V& eye,
                     const V& direction, const V& origin, const V& stride) {
  RaySpan<T> span;
  for (const Plane& plane : planes) {
    const V normal(plane.normal);
    span.keep(glm::dot(normal, eye) - plane.offset, glm::dot(normal, direction));
  }
  for (int k = 0; k < 3; ++k) {
    const T mm = section.spacing[k];
    span.keep(mm * origin[k], mm * stride[k]);
    span.keep(mm * (static_cast<T>(section.dims[k] - 1) - origin[k]), -mm * stride[k]);
  }
  return span;
}

}  // namespace clipgs
