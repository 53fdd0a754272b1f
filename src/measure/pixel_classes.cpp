#include "measure/pixel_classes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace clipgs {

namespace {

/// Where the ray enters what the plane keeps, mm; infinity if it does not come from the other side.
float entry(const Camera& camera, const Vec3& ray, const Plane& plane) {
  const float slope = glm::dot(plane.normal, ray);
  const float depth = -plane.signed_distance(camera.position);
  return depth > 0 && slope > 0 ? depth / slope : std::numeric_limits<float>::infinity();
}

void require_size(const Image& hits, const Camera& camera) {
  if (hits.width != camera.width || hits.height != camera.height || hits.channels != 1) {
    throw Error("first hits of {}×{} pixels are not of a camera of {}×{}", hits.width, hits.height,
                camera.width, camera.height);
  }
}

}  // namespace

const char* pixel_class_name(PixelClass which) {
  switch (which) {
    case PixelClass::kFace:
      return "face";
    case PixelClass::kOpened:
      return "opened";
    case PixelClass::kOutside:
      return "outside";
  }
  return "";
}

std::vector<PixelClass> classify_pixels(const FirstHits& hits, const Camera& camera,
                                        const std::optional<Plane>& plane,
                                        std::span<const Plane> ends, float tolerance) {
  require_size(hits.cut, camera);
  if (plane) {
    require_size(hits.uncut, camera);
  }
  const auto on = [&](const Plane& side, const Vec3& point) {
    return std::abs(side.signed_distance(point)) <= tolerance;
  };
  const auto classify = [&](const Vec3& ray, float hit, float uncut_hit) {
    const Vec3 point = camera.position + hit * ray;
    const float enters =
        plane ? entry(camera, ray, *plane) : std::numeric_limits<float>::infinity();
    const bool on_plane = std::isfinite(enters) && on(*plane, point);
    const bool on_end = std::ranges::any_of(ends, [&](const Plane& end) { return on(end, point); });
    if (hit > 0 && (on_plane || on_end)) {
      return PixelClass::kFace;
    }
    const bool took_away = std::isfinite(enters) && uncut_hit > 0 && uncut_hit < enters;
    return took_away ? PixelClass::kOpened : PixelClass::kOutside;
  };
  std::vector<PixelClass> classes;
  classes.reserve(hits.cut.pixels());
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Vec3 ray =
          camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      classes.push_back(classify(ray, *hits.cut.at(x, y), plane ? *hits.uncut.at(x, y) : 0));
    }
  }
  return classes;
}

}  // namespace clipgs
