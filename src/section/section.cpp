#include "section/section.h"

#include <algorithm>

#include "core/image.h"

namespace clipgs {

Vec3 Section::sample(const Vec3& index) const {
  const Vec3 at = glm::clamp(index, Vec3(0), Vec3(dims - 1));
  const IVec3 low = glm::min(IVec3(at), glm::max(dims - 2, IVec3(0)));
  const IVec3 step = glm::min(IVec3(1), dims - 1 - low);
  const Vec3 t = at - Vec3(low);
  const size_t x = static_cast<size_t>(step.x) * channels;
  const size_t y = static_cast<size_t>(step.y) * dims.x * channels;
  const size_t z = static_cast<size_t>(step.z) * dims.x * dims.y * channels;
  const std::uint8_t* v =
      &voxels[((static_cast<size_t>(low.z) * dims.y + low.y) * dims.x + low.x) * channels];
  Vec3 result(0);
  for (int c = 0; c < channels; ++c, ++v) {
    const float near =
        glm::mix(glm::mix<float>(v[0], v[x], t.x), glm::mix<float>(v[y], v[y + x], t.x), t.y);
    const float far = glm::mix(glm::mix<float>(v[z], v[z + x], t.x),
                               glm::mix<float>(v[z + y], v[z + y + x], t.x), t.y);
    result[c] = glm::mix(near, far, t.z);
  }
  return result;
}

float Section::code(const Vec3& sampled) const {
  // Rec. 709 luma, as photographs are loaded.
  return channels == 1 ? sampled.x : glm::dot(sampled, Vec3(0.2126f, 0.7152f, 0.0722f));
}

float Section::surface_depth(const Vec3& normal) const {
  return 0.5f * glm::length((normal * direction) * source_spacing);
}

Vec3 photo_albedo(const Vec3& sampled) {
  return {linear_from_srgb(sampled.r / 255), linear_from_srgb(sampled.g / 255),
          linear_from_srgb(sampled.b / 255)};
}

}  // namespace clipgs
