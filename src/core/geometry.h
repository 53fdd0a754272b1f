#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numbers>

namespace clipgs {

// World space is RAS: x to the patient's Right, y Anterior, z Superior, in millimetres.
using Vec2 = glm::vec2;
using Vec3 = glm::vec3;
using Vec4 = glm::vec4;
using Mat3 = glm::mat3;  // column-major: m[column][row]
using Mat4 = glm::mat4;
using Quat = glm::quat;  // constructor order (w, x, y, z)
using IVec3 = glm::ivec3;

inline constexpr float kPi = std::numbers::pi_v<float>;

/// A clipping plane. The kept side is where signed_distance(x) >= 0.
struct Plane {
  Vec3 normal{0, 0, 1};  ///< unit vector, towards the kept side
  float offset = 0;      ///< mm: the plane is normal·x = offset

  /// Distance of `x` from the plane in mm, positive on the kept side.
  float signed_distance(const Vec3& x) const { return glm::dot(normal, x) - offset; }
  /// The same plane keeping the other side.
  Plane flipped() const { return {-normal, -offset}; }
};

/// Axis-aligned box in world space; empty until a point is added.
struct Box {
  Vec3 min{std::numeric_limits<float>::max()};
  Vec3 max{std::numeric_limits<float>::lowest()};

  bool empty() const { return min.x > max.x; }
  void add(const Vec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  Vec3 center() const { return 0.5f * (min + max); }
  Vec3 size() const { return max - min; }
};

/// A ball in world space, mm.
struct Sphere {
  Vec3 center{0};
  float radius = 0;  ///< mm
};

/// Interval [min, max] of normal·x over the corners of `box`.
glm::vec2 project_box(const Box& box, const Vec3& normal);

/// Two unit vectors that complete unit `n` to a right-handed basis (Duff et al. 2017).
void orthonormal_basis(const Vec3& n, Vec3& tangent, Vec3& bitangent);

/// Point `i` of `n` spread evenly over the unit sphere (Fibonacci spiral).
Vec3 fibonacci_sphere(int i, int n);

}  // namespace clipgs
