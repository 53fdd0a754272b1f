#include "splat/kept_share.h"

#include <algorithm>
#include <cmath>

#include "splat/projection.h"

namespace clipgs {
namespace {

/// Share of pixel (x, y) on the kept side of a plane at depth z, before clamping: (x, y, 1)·result.
Vec3 share_at_depth(const Camera& camera, const Plane& plane, float z) {
  const Vec3 n = camera.rotation * plane.normal;
  const Vec3 distance(
      z * n.x / camera.fx, z * n.y / camera.fy,
      plane.signed_distance(camera.position) + z * n.z -
          z * (n.x * (camera.cx - 0.5f) / camera.fx + n.y * (camera.cy - 0.5f) / camera.fy));
  constexpr float kLeastSlope = 1e-6f;  // mm a pixel
  const float slope = std::max(std::abs(distance.x) + std::abs(distance.y), kLeastSlope);
  return distance / slope + Vec3(0, 0, 0.5f);
}

}  // namespace

KeptShare::KeptShare(const Camera& camera, const Cut& cut, const Sphere& body) {
  if (body.radius <= 0) {
    return;
  }
  const float middle = glm::dot(camera.forward(), body.center - camera.position);
  const float right = static_cast<float>(camera.width) - 1;
  const float bottom = static_cast<float>(camera.height) - 1;
  for (const Plane& plane : cut.planes()) {
    const Edge edge = {share_at_depth(camera, plane, std::max(kNearPlane, middle - body.radius)),
                       share_at_depth(camera, plane, std::max(kNearPlane, middle + body.radius))};
    const bool is_whole = std::ranges::any_of(edge, [&](const Vec3& line) {
      return line.z + std::min(0.0f, line.x * right) + std::min(0.0f, line.y * bottom) >= 1;
    });
    if (!is_whole) {
      edges_.push_back(edge);
    }
  }
}

float KeptShare::at(int x, int y) const {
  const Vec3 pixel(x, y, 1);
  float share = 1;
  for (const Edge& edge : edges_) {
    share *= std::clamp(std::max(glm::dot(edge[0], pixel), glm::dot(edge[1], pixel)), 0.0f, 1.0f);
  }
  return share;
}

}  // namespace clipgs
