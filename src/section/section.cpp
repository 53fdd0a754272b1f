#include "section/section.h"

#include "core/image.h"

namespace clipgs {

float Section::surface_depth(const Vec3& normal) const {
  return 0.5f * glm::length((normal * direction) * source_spacing);
}

Vec3 photo_albedo(const Vec3& sampled) {
  return {linear_from_srgb(sampled.r / 255), linear_from_srgb(sampled.g / 255),
          linear_from_srgb(sampled.b / 255)};
}

}  // namespace clipgs
