#include "light/occluders.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clipgs {

float Occluders::extinction_at(const Vec3& index) const {
  const IVec3 low(glm::floor(index));
  const Vec3 t = index - Vec3(low);
  float sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const IVec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
    const IVec3 sample = low + step;
    const bool inside =
        glm::all(glm::greaterThanEqual(sample, IVec3(0))) && glm::all(glm::lessThan(sample, dims));
    if (inside) {
      const Vec3 weight = glm::mix(1.0f - t, t, Vec3(step));
      sum += weight.x * weight.y * weight.z * extinction[offset(sample)];
    }
  }
  return sum;
}

const Vec3& Occluders::albedo_at(const Vec3& world) const {
  const IVec3 sample(glm::floor(index_from_world(world) + 0.5f));
  return albedo[offset(glm::clamp(sample, IVec3(0), dims - 1))];
}

float horizon_distance(const Occluders& occluders, const Vec3& from, const Vec3& direction) {
  constexpr float kHalf = std::numbers::ln2_v<float>;  // optical depth
  const float length = 0.5f * occluders.spacing;
  const Vec3 start = occluders.index_from_world(from);
  const Vec3 step = (direction * occluders.direction) / occluders.spacing;
  float leave = kNever;
  for (int k = 0; k < 3; ++k) {
    if (step[k] != 0) {
      const float side = step[k] > 0 ? static_cast<float>(occluders.dims[k]) : -1.0f;
      leave = std::min(leave, (side - start[k]) / step[k]);
    }
  }
  const int steps = static_cast<int>(std::ceil(std::max(0.0f, leave / length - 0.5f)));
  float depth = 0;
  for (int i = 0; i < steps; ++i) {
    const float t = (static_cast<float>(i) + 0.5f) * length;
    depth += length * occluders.extinction_at(start + t * step);
    if (depth >= kHalf) {
      return t;
    }
  }
  return kNever;
}

float exit_distance(const Cut& cut, const Vec3& from, const Vec3& direction) {
  float nearest = kNever;
  for (const Plane& plane : cut.planes()) {
    const float slope = -glm::dot(plane.normal, direction);
    if (slope > 0) {
      nearest = std::min(nearest, std::max(0.0f, plane.signed_distance(from)) / slope);
    }
  }
  return nearest;
}

}  // namespace clipgs
