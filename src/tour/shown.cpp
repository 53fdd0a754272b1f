#include "tour/shown.h"

#include <algorithm>

namespace clipgs {

namespace {

double distance_of(const ShownView& view, const Sphere& sphere) {
  return std::max(1.0, framing_distance(sphere.radius) + view.back);
}

}  // namespace

Cut cut_of(const Shown& shown) {
  std::vector<Plane> planes;
  for (const ShownCut& cut : shown.cuts) {
    planes.push_back({Vec3(cut.normal), static_cast<float>(cut.offset)});
    if (cut.thickness) {
      planes.push_back({Vec3(-cut.normal), static_cast<float>(-cut.offset - *cut.thickness)});
    }
  }
  return Cut(std::move(planes));
}

Camera camera_of(const ShownView& view, const Sphere& sphere, int width, int height) {
  const Vec3 direction =
      view_direction(static_cast<float>(view.azimuth), static_cast<float>(view.elevation));
  const Vec3 target = sphere.center + Vec3(view.pan);
  const auto distance = static_cast<float>(distance_of(view, sphere));
  Camera camera = look_at(target + distance * direction, target, Vec3(0, 0, 1), width, height);
  camera.fx *= static_cast<float>(view.zoom);
  camera.fy *= static_cast<float>(view.zoom);
  return camera;
}

ShownView reframed(const ShownView& view, const Sphere& from, const Sphere& to) {
  ShownView result = view;
  result.pan = glm::dvec3(from.center) + view.pan - glm::dvec3(to.center);
  result.back = distance_of(view, from) - framing_distance(to.radius);
  return result;
}

}  // namespace clipgs
