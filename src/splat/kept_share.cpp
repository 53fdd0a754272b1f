#include "splat/kept_share.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "splat/hull.h"
#include "splat/projection.h"

namespace clipgs {
namespace {

/// Of pixel (x, y), (x, y, 1)·result is how far its ray goes along a direction to depth 1.
Vec3 ray_along(const Camera& camera, const Vec3& direction) {
  const Vec3 n = camera.rotation * direction;
  const Vec2 slope(n.x / camera.fx, n.y / camera.fy);
  return {slope, n.z - slope.x * (camera.cx - 0.5f) - slope.y * (camera.cy - 0.5f)};
}

/// The least and the greatest depth of a hull's box.
Vec2 depths_of(const Hull& hull, const Camera& camera) {
  Vec2 depths(std::numeric_limits<float>::max(), kNearPlane);
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 at;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      at[axis] = (corner >> axis & 1) != 0 ? hull.high[k] : hull.low[k];
    }
    const float depth = glm::dot(camera.forward(), at - camera.position);
    depths = {std::min(depths.x, depth), std::max(depths.y, depth)};
  }
  return {std::max(depths.x, kNearPlane), depths.y};
}

/// Whether a plane is so steep everywhere in the picture that splats show well where it ends them:
/// `along`, ray_along() of its normal.
bool is_steep(const Camera& camera, const Vec3& along) {
  constexpr float kSteep = 0.25f;  // sine of its angle with a ray
  const Vec2 last(camera.width - 1, camera.height - 1);
  const float side = along.z + 0.5f * glm::dot(Vec2(along), last);
  for (int corner = 0; corner < 4; ++corner) {
    const Vec2 pixel((corner & 1) != 0 ? last.x : 0, (corner & 2) != 0 ? last.y : 0);
    const Vec2 slope((pixel.x + 0.5f - camera.cx) / camera.fx,
                     (pixel.y + 0.5f - camera.cy) / camera.fy);
    const float sine = glm::dot(along, Vec3(pixel, 1)) / glm::length(Vec3(slope, 1));
    if (sine * (side > 0 ? 1.0f : -1.0f) < kSteep) {
      return false;
    }
  }
  return true;
}

}  // namespace

KeptShare::KeptShare(const Camera& camera, const Cut& cut, const Gaussians& body) {
  if (cut.empty()) {
    return;
  }
  const Hull hull(body);
  margin_ = kMargin / camera.fx;
  const Vec2 depths = depths_of(hull, camera);
  const Vec2 last(camera.width - 1, camera.height - 1);
  for (const Plane& plane : cut.planes()) {
    const Vec3 along = ray_along(camera, plane.normal);
    if (is_steep(camera, along)) {
      continue;
    }
    constexpr float kLeastSlope = 1e-9f;
    const float slope = std::max(std::abs(along.x) + std::abs(along.y), kLeastSlope);
    const Edge edge{along / slope, plane.signed_distance(camera.position) / slope};
    const Vec2 least = glm::min(Vec2(0), Vec2(edge.along) * last);
    const float farthest = std::max(edge.near / depths.x, edge.near / depths.y);
    if (least.x + least.y + edge.along.z + farthest < 0.5f) {
      edges_.push_back(edge);
    }
  }
  for (size_t k = 0; !edges_.empty() && k < Hull::kDirections; ++k) {
    const Vec3& direction = Hull::directions()[k];
    const float eye = glm::dot(direction, camera.position);
    slabs_.push_back({ray_along(camera, direction), hull.low[k] - eye, hull.high[k] - eye});
  }
}

float KeptShare::at(int x, int y) const {
  const Vec3 pixel(x, y, 1);
  float near = kNearPlane;
  float far = std::numeric_limits<float>::max();
  for (const Slab& slab : slabs_) {
    constexpr float kLeast = 1e-6f;  // of a ray across: it meets neither plane
    const float along = glm::dot(slab.along, pixel);
    if (std::abs(along) > kLeast) {
      const Vec2 ends = Vec2(slab.low, slab.high) / along;
      near = std::max(near, std::min(ends.x, ends.y));
      far = std::min(far, std::max(ends.x, ends.y));
    }
  }
  near *= 1 - margin_;
  far = std::max(far * (1 + margin_), kNearPlane);
  float share = 1;
  for (const Edge& edge : edges_) {
    const float kept = glm::dot(edge.along, pixel) + std::max(edge.near / near, edge.near / far);
    share *= std::clamp(kept + 0.5f, 0.0f, 1.0f);
  }
  return share;
}

}  // namespace clipgs
