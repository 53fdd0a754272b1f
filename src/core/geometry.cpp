#include "core/geometry.h"

#include <cmath>
#include <numbers>

namespace clipgs {

glm::vec2 project_box(const Box& box, const Vec3& normal) {
  const float center = glm::dot(normal, box.center());
  const float half = glm::dot(glm::abs(normal), box.size()) * 0.5f;
  return {center - half, center + half};
}

void orthonormal_basis(const Vec3& n, Vec3& tangent, Vec3& bitangent) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  tangent = {1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x};
  bitangent = {b, sign + n.y * n.y * a, -n.y};
}

Vec3 fibonacci_sphere(int i, int n) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double z = 1.0 - (2.0 * i + 1.0) / n;
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  const double phi = golden_angle * i;
  return Vec3(r * std::cos(phi), r * std::sin(phi), z);
}

}  // namespace clipgs
