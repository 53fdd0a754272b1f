#include "light/light_field.h"

#include <functional>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr float kRadius = 40;  // mm, of the hollow

/// Opaque matter where `solid` says so, around the origin, 2 mm between samples.
Occluders make_occluders(float half, const std::function<bool(const Vec3&)>& solid,
                         const Vec3& albedo = Vec3(0)) {
  Occluders occluders;
  occluders.spacing = 2;
  occluders.dims = IVec3(static_cast<int>(half) + 1);
  occluders.origin = Vec3(-half);
  for (int z = 0; z < occluders.dims.z; ++z) {
    for (int y = 0; y < occluders.dims.y; ++y) {
      for (int x = 0; x < occluders.dims.x; ++x) {
        occluders.extinction.push_back(solid(occluders.world_from_index(Vec3(x, y, z))) ? 10.0f
                                                                                        : 0.0f);
      }
    }
  }
  occluders.albedo.assign(occluders.extinction.size(), albedo);
  return occluders;
}

Occluders hollow_block(const Vec3& albedo = Vec3(0)) {
  return make_occluders(60, [](const Vec3& x) { return glm::length(x) > kRadius; }, albedo);
}

LightRig white_sky() { return {Vec3(1), Vec3(1), Vec3(1), {}}; }

// The upper half of the block is taken away.
const Plane kLower{{0, 0, -1}, 0};

/// Points of the bowl that the cut opens, with normals into it.
std::vector<Vec3> bowl_normals() {
  std::vector<Vec3> normals;
  for (int i = 0; i < 60; ++i) {
    const Vec3 normal = fibonacci_sphere(i, 60);
    if (normal.z > 0.3f) {
      normals.push_back(normal);
    }
  }
  return normals;
}

TEST(Horizons, AreDistancesToMatter) {
  const Horizons horizons(hollow_block(), 25);
  EXPECT_EQ(horizons.dims(), IVec3(25));
  const size_t middle = horizons.offset(horizons.nearest(Vec3(0)));
  ASSERT_TRUE(horizons.in_air(middle));
  for (int i = 0; i < Horizons::kDirections; ++i) {
    EXPECT_NEAR(horizons.distance(middle, i), kRadius, 2);
  }
  EXPECT_FALSE(horizons.in_air(horizons.offset(horizons.nearest(Vec3(50, 0, 0)))));
  // Straight from a node beside the wall, too.
  const IVec3 node = horizons.nearest(Vec3(30, 0, 0));
  const Vec3 at = horizons.world_of(node);
  for (int i = 0; i < Horizons::kDirections; ++i) {
    const float along = glm::dot(at, Horizons::directions()[static_cast<size_t>(i)]);
    const float exact = -along + std::sqrt(along * along + kRadius * kRadius - glm::dot(at, at));
    EXPECT_NEAR(horizons.distance(horizons.offset(node), i), exact, 3);
  }
  EXPECT_THROW(Horizons(hollow_block(), 1), Error);
}

TEST(ExitDistance, IsThatOfTheFirstPlane) {
  const Cut slab({Plane{{0, 0, 1}, -10}, Plane{{0, 0, -1}, -30}});  // −10 ≤ z ≤ 30
  EXPECT_FLOAT_EQ(exit_distance(slab, Vec3(0), {0, 0, 1}), 30);
  EXPECT_FLOAT_EQ(exit_distance(slab, Vec3(0), {0, 0, -1}), 10);
  EXPECT_FLOAT_EQ(exit_distance(slab, Vec3(0), {0.8f, 0, -0.6f}), 10 / 0.6f);
  EXPECT_EQ(exit_distance(slab, Vec3(0), {1, 0, 0}), kNever);
  EXPECT_EQ(exit_distance(Cut(), Vec3(0), {0, 0, 1}), kNever);
}

TEST(LightField, AClosedHollowIsDarkAndAnOpenedOneIsNot) {
  const Occluders block = hollow_block(Vec3(0.8f));
  const Horizons horizons(block, 25);
  const LightField closed(horizons, block, white_sky(), Cut());
  const LightField opened(horizons, block, white_sky(), kLower);
  for (const Vec3& normal : bowl_normals()) {
    EXPECT_LT(closed.reflected(-kRadius * normal, normal).g, 1e-6f);
    EXPECT_GT(opened.reflected(-kRadius * normal, normal).g, 0.4f);
  }
}

// Of the hemisphere above any point of a half bowl the opening has half, and the bowl the rest: in
// a sphere the form factor from any point of the wall to a part of it is that part's share of the
// sphere's area. So all of the bowl radiates E = 1/2 + albedo·E/2, times the sky.
TEST(LightField, ABowlIsLitAsTheTheoryOfTheIntegratingSphereSays) {
  const Vec3 albedo(0.8f, 0.5f, 0);
  const Occluders block = hollow_block(albedo);
  const Horizons horizons(block, 33);
  const LightField direct(horizons, block, white_sky(), kLower, {.bounces = 0});
  const LightField bounced(horizons, block, white_sky(), kLower, {.bounces = 12});
  Vec3 mean(0);
  float count = 0;
  for (const Vec3& normal : bowl_normals()) {
    EXPECT_NEAR(direct.reflected(-kRadius * normal, normal).g, 0.5f, 0.12f);
    mean += bounced.reflected(-kRadius * normal, normal);
    ++count;
  }
  mean /= count;
  for (int k = 0; k < 3; ++k) {
    const float exact = 0.5f / (1 - 0.5f * albedo[k]);
    EXPECT_NEAR(mean[k], exact, 0.12f * exact) << k;  // nodes are 4 mm apart
  }
}

TEST(LightField, OnOpenGroundASurfaceSeesAllOfItsLights) {
  const Occluders ground = make_occluders(40, [](const Vec3& x) { return x.z < -10; });
  const Horizons horizons(ground, 21);
  LightRig rig = white_sky();
  const Vec3 up(0, 0, 1);
  EXPECT_NEAR(LightField(horizons, ground, rig, Cut()).reflected({0, 0, -10}, up).g, 1, 0.03f);
  // A sky that is brightest above, as face_diffuse() has it in closed form.
  rig.sky_horizon = Vec3(0);
  EXPECT_NEAR(LightField(horizons, ground, rig, Cut()).reflected({0, 0, -10}, up).g, 2.0f / 3,
              0.02f);
  rig.sky_top = rig.sky_bottom = Vec3(0);
  rig.keys.push_back({{0, 0, 1}, Vec3(1, 2, 3), 0.1f, 0});
  // Degree 2 of a light straight above: 17/16 of what it is.
  const Vec3 lit = LightField(horizons, ground, rig, Cut()).reflected({0, 0, -10}, up);
  EXPECT_NEAR(lit.r, 17.0f / 16, 0.02f);
  EXPECT_NEAR(lit.b, 51.0f / 16, 0.06f);
  // … and nothing of one below the ground.
  rig.keys[0].direction = {0, 0, -1};
  EXPECT_LT(LightField(horizons, ground, rig, Cut()).reflected({0, 0, -10}, up).r, 1e-3f);
}

TEST(LightField, IsTheSameOnOneThread) {
  const Occluders block = hollow_block(Vec3(0.7f));
  const auto look = [&] {
    const Horizons horizons(block, 17);
    const LightField field(horizons, block, white_sky(), kLower);
    std::vector<Vec3> seen;
    for (const Vec3& normal : bowl_normals()) {
      seen.push_back(field.reflected(-kRadius * normal, normal));
    }
    return seen;
  };
  const std::vector<Vec3> many = look();
  set_thread_count(1);
  const std::vector<Vec3> one = look();
  set_thread_count(0);
  EXPECT_EQ(many, one);
}

}  // namespace
}  // namespace clipgs
