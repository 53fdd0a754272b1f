#include "light/occluders.h"

#include <algorithm>
#include <cmath>

namespace clipgs {
namespace {

constexpr float kHalf = 127.5f;  // of what takes all of the light

}  // namespace

float Occluders::coverage_at(const Vec3& index) const {
  const IVec3 low(glm::floor(index));
  const Vec3 t = index - Vec3(low);
  const bool inside =
      glm::all(glm::greaterThanEqual(low, IVec3(0))) && glm::all(glm::lessThan(low, dims - 1));
  float sum = 0;
  if (inside) {
    const std::uint8_t* c = &coverage[offset(low)];
    const auto row = static_cast<size_t>(dims.x);
    const size_t slice = row * static_cast<size_t>(dims.y);
    const auto along_x = [&](size_t at) { return glm::mix<float>(c[at], c[at + 1], t.x); };
    return glm::mix(glm::mix(along_x(0), along_x(row), t.y),
                    glm::mix(along_x(slice), along_x(slice + row), t.y), t.z);
  }
  for (int corner = 0; corner < 8; ++corner) {
    const IVec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
    const IVec3 sample = low + step;
    if (glm::all(glm::greaterThanEqual(sample, IVec3(0))) &&
        glm::all(glm::lessThan(sample, dims))) {
      const Vec3 weight = glm::mix(1.0f - t, t, Vec3(step));
      sum += weight.x * weight.y * weight.z * coverage[offset(sample)];
    }
  }
  return sum;
}

EmptySpace find_empty_space(const Occluders& occluders) {
  return {occluders.dims, [&](const IVec3& low, const IVec3& high) {
            bool blocks = false;
            for (int z = low.z; z <= high.z; ++z) {
              for (int y = low.y; y <= high.y; ++y) {
                const std::uint8_t* row = &occluders.coverage[occluders.offset({low.x, y, z})];
                for (int x = 0; x <= high.x - low.x; ++x) {
                  blocks = blocks || static_cast<float>(row[x]) >= kHalf;
                }
              }
            }
            return EmptySpace::Block{blocks, false};
          }};
}

float horizon_distance(const Occluders& occluders, const EmptySpace& empty, const Vec3& from,
                       const Vec3& direction, float start) {
  const float length = 0.7f * occluders.spacing;
  const Vec3 origin = occluders.index_from_world(from);
  const Vec3 step = (direction * occluders.direction) / occluders.spacing;
  float leave = kNever;
  for (int k = 0; k < 3; ++k) {
    if (step[k] != 0) {
      const float side = step[k] > 0 ? static_cast<float>(occluders.dims[k]) : -1.0f;
      leave = std::min(leave, (side - origin[k]) / step[k]);
    }
  }
  float before = 0;
  float t = start;
  while (t < leave) {
    const Vec3 at = origin + t * step;
    const float leap = empty.leap(at, step);
    if (leap > 0) {
      t += leap;
      before = 0;
      continue;
    }
    const float coverage = occluders.coverage_at(at);
    if (coverage >= kHalf) {
      const float back = (coverage - kHalf) / std::max(coverage - before, 1e-3f);
      return std::max(start, t - std::min(1.0f, back) * length);
    }
    before = coverage;
    t += length;
  }
  return kNever;
}

float exit_distance(std::span<const Plane> planes, const Vec3& from, const Vec3& direction) {
  float nearest = kNever;
  for (const Plane& plane : planes) {
    const float slope = -glm::dot(plane.normal, direction);
    if (slope > 0) {
      nearest = std::min(nearest, std::max(0.0f, plane.signed_distance(from)) / slope);
    }
  }
  return nearest;
}

}  // namespace clipgs
