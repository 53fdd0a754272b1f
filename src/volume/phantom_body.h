#pragma once

#include <vector>

#include "core/random.h"
#include "volume/phantom_paint.h"

namespace clipgs::phantom {

// The layout of the torso: RAS mm, the origin in the middle of the trunk. Negative distances lie
// inside.

/// Distance to the skin.
float skin(const Vec3& p);
/// Thickness of the fat under the skin, and of the wall of muscle (and ribs) under the fat.
float fat_thickness(const Vec3& p);
float wall_thickness(const Vec3& p);
/// Distance to the inner side of the wall: of the chest's and the belly's cavity.
inline float cavity(const Vec3& p) { return skin(p) + fat_thickness(p) + wall_thickness(p); }

/// Height of the diaphragm above (x, y).
float diaphragm(const Vec3& p);
/// Distance to the left (side −1) or right (+1) lung.
float lung(const Vec3& p, float side);
float liver(const Vec3& p);

/// Front-to-back position of the vertebral bodies' axis at height z.
float spine_y(float z);
/// A point on the surface `depth` mm under the skin at height z: angle 0 at the back, π at the
/// front.
Vec3 under_skin(float angle, float z, float side, float depth);

void paint_wall(Painter& painter);
void paint_organs(Painter& painter);
void paint_chest(Painter& painter, std::uint64_t seed);
void paint_vessels(Painter& painter, std::uint64_t seed);
void paint_skeleton(Painter& painter);

/// A branching tree of tubes from `start`, kept where inside(p) holds: each generation forks in
/// two, by Murray's law (radius³ is shared out).
struct TreeShape {
  Vec3 start{0};
  Vec3 direction{0, 0, 1};
  float length = 30;  ///< mm of the first branch
  float radius = 5;   ///< mm of the first branch
  int generations = 6;
};
template <typename Inside>
void grow_tree(Rng& rng, const TreeShape& shape, const Inside& inside,
               std::vector<Segment>& segments) {
  const Vec3 end = shape.start + shape.direction * shape.length;
  if (shape.generations == 0 || !inside(end)) {
    return;
  }
  constexpr float kMurray = 0.794f;  // 2^(−1/3)
  segments.push_back({shape.start, end, shape.radius, shape.radius * kMurray});
  Vec3 tangent;
  Vec3 bitangent;
  orthonormal_basis(shape.direction, tangent, bitangent);
  const float turn = 6.2831853f * rng.uniform();
  const Vec3 sideways = std::cos(turn) * tangent + std::sin(turn) * bitangent;
  for (const float sign : {-1.0f, 1.0f}) {
    const float spread = sign * (0.4f + 0.35f * rng.uniform());
    TreeShape child = shape;
    child.start = end;
    child.direction =
        glm::normalize(shape.direction * std::cos(spread) + sideways * std::sin(spread));
    child.length = shape.length * (0.72f + 0.2f * rng.uniform());
    child.radius = shape.radius * kMurray;
    child.generations = shape.generations - 1;
    grow_tree(rng, child, inside, segments);
  }
}

}  // namespace clipgs::phantom
