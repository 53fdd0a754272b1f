#include "light/cut_light.h"

#include <functional>
#include <gtest/gtest.h>

#include "core/cut.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr float kRadius = 40;  // mm, of the hollow
constexpr float kHalf = 60;    // mm, half the side of the block around it

/// Opaque matter where `solid` says so, around the origin, 2 mm between samples.
Occluders make_occluders(const std::function<bool(const Vec3&)>& solid) {
  Occluders occluders;
  occluders.spacing = 2;
  occluders.dims = IVec3(static_cast<int>(kHalf) + 1);
  occluders.origin = Vec3(-kHalf);
  for (int z = 0; z < occluders.dims.z; ++z) {
    for (int y = 0; y < occluders.dims.y; ++y) {
      for (int x = 0; x < occluders.dims.x; ++x) {
        const Vec3 at = occluders.world_from_index(Vec3(x, y, z));
        occluders.coverage.push_back(solid(at) ? 255 : 0);
      }
    }
  }
  return occluders;
}

PatchGrid make_grid() { return {IVec3(31), 4, Mat3(1), Vec3(-kHalf)}; }

/// The inside of a hollow ball.
CutLight hollow(const LightRig& rig, const Vec3& reflectance) {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 outwards = fibonacci_sphere(i, 20000);
    points.push_back({kRadius * outwards, -outwards, reflectance});
  }
  return {make_occluders([](const Vec3& x) { return glm::length(x) > kRadius; }),
          Patches(make_grid(), points), rig, 1};
}

LightRig white_sky() { return {Vec3(1), Vec3(1), Vec3(1), {}}; }

LightRig studio() {
  LightRig rig{Vec3(0.4f, 0.5f, 0.6f), Vec3(0.3f), Vec3(0.2f, 0.1f, 0.1f), {}};
  rig.keys = {{glm::normalize(Vec3(0.3f, -0.2f, 0.9f)), Vec3(0.7f, 0.6f, 0.5f), 0.14f},
              {glm::normalize(Vec3(-0.8f, 0.3f, 0.4f)), Vec3(0.2f), 0.3f}};
  return rig;
}

// The upper half of the block is taken away.
const Plane kLower{{0, 0, -1}, 0};

/// Normals of points of the bowl that a cut leaves.
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

Vec3 at_bowl(const CutLight& light, std::span<const Vec3> solution, const Vec3& normal) {
  return light_at(light.patches(), solution, -kRadius * normal, normal);
}

/// Direct light in a hollow ball by its definition, in double precision: (1/π)·∫ V·L·cos dω over
/// many directions, with the distances to the sphere and to the planes in closed form.
glm::dvec3 reference(const LightRig& rig, std::span<const Plane> planes, const glm::dvec3& normal) {
  const double r = kRadius;
  const glm::dvec3 from = -(r - 1) * normal;
  const auto visible = [&](const glm::dvec3& direction) {
    const double b = glm::dot(from, direction);
    const double wall = -b + std::sqrt(b * b + r * r - glm::dot(from, from));
    double leave = 1e30;
    for (const Plane& plane : planes) {
      const double slope = -glm::dot(glm::dvec3(plane.normal), direction);
      if (slope > 0) {
        leave = std::min(leave,
                         (glm::dot(glm::dvec3(plane.normal), from) - double{plane.offset}) / slope);
      }
    }
    return leave <= wall;
  };
  constexpr int kSky = 40000;
  glm::dvec3 sum(0);
  for (int i = 0; i < kSky; ++i) {
    const glm::dvec3 direction(fibonacci_sphere(i, kSky));
    const double cosine = glm::dot(direction, normal);
    if (cosine > 0 && visible(direction)) {
      const glm::dvec3 end(direction.z >= 0 ? rig.sky_top : rig.sky_bottom);
      sum +=
          4.0 / kSky * cosine * glm::mix(glm::dvec3(rig.sky_horizon), end, std::abs(direction.z));
    }
  }
  for (const KeyLight& key : rig.keys) {
    constexpr int kDisc = 400;
    Vec3 u;
    Vec3 v;
    orthonormal_basis(key.direction, u, v);
    for (int i = 0; i < kDisc; ++i) {
      const double radius = std::sqrt((i + 0.5) / kDisc) * std::tan(double{key.angular_radius});
      const double angle = 2.399963 * i;
      const glm::dvec3 direction =
          glm::normalize(glm::dvec3(key.direction) + radius * (std::cos(angle) * glm::dvec3(u) +
                                                               std::sin(angle) * glm::dvec3(v)));
      const double cosine = glm::dot(direction, normal);
      if (cosine > 0 && visible(direction)) {
        sum += cosine / kDisc * glm::dvec3(key.radiance);
      }
    }
  }
  return sum;
}

TEST(Horizons, AreDistancesToMatter) {
  const Occluders block = make_occluders([](const Vec3& x) { return glm::length(x) > kRadius; });
  const EmptySpace empty = find_empty_space(block);
  const Vec3 from(0, 0, 20);
  for (int i = 0; i < 64; ++i) {
    const Vec3 direction = fibonacci_sphere(i, 64);
    const float along = glm::dot(from, direction);
    const float exact =
        -along + std::sqrt(along * along + kRadius * kRadius - glm::dot(from, from));
    EXPECT_NEAR(horizon_distance(block, empty, from, direction, 0), exact, 1.5f);
  }
  // Beyond the grid there is nothing.
  EXPECT_EQ(horizon_distance(block, empty, {0, 0, kHalf + 3}, {0, 0, 1}, 0), kNever);
}

TEST(ExitDistance, IsThatOfTheFirstPlane) {
  const Cut slab({Plane{{0, 0, 1}, -10}, Plane{{0, 0, -1}, -30}});  // −10 ≤ z ≤ 30
  EXPECT_FLOAT_EQ(exit_distance(slab.planes(), Vec3(0), {0, 0, 1}), 30);
  EXPECT_FLOAT_EQ(exit_distance(slab.planes(), Vec3(0), {0, 0, -1}), 10);
  EXPECT_FLOAT_EQ(exit_distance(slab.planes(), Vec3(0), {0.8f, 0, -0.6f}), 10 / 0.6f);
  EXPECT_EQ(exit_distance(slab.planes(), Vec3(0), {1, 0, 0}), kNever);
  EXPECT_EQ(exit_distance({}, Vec3(0), {0, 0, 1}), kNever);
  // From a point that is not kept every ray that points away from what is kept has left.
  EXPECT_EQ(exit_distance(slab.planes(), Vec3(0, 0, 40), {0, 0, 1}), 0);
}

TEST(Patches, AWallAndItsBackAreApart) {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      const Vec3 at(i, j, 0);
      points.push_back({at + Vec3(0, 0, 0.5f), {0, 0, 1}, Vec3(0.9f)});
      points.push_back({at - Vec3(0, 0, 0.5f), {0, 0, -1}, Vec3(0.1f)});
    }
  }
  const Patches patches({IVec3(8, 8, 4), 4, Mat3(1), Vec3(0, 0, -6)}, points);
  for (const float side : {1.0f, -1.0f}) {
    float weights = 0;
    patches.interpolate({10, 10, 0}, {0, 0, side}, [&](size_t patch, float weight) {
      EXPECT_EQ(patches.all()[patch].normal.z, side);
      weights += weight;
    });
    EXPECT_GT(weights, 0.2f);
    EXPECT_LE(weights, 1.0001f);
    const std::int32_t met = patches.met_by({10, 10, 0}, {0, 0, -side});
    ASSERT_NE(met, Patches::kNone);
    EXPECT_NEAR(patches.all()[static_cast<size_t>(met)].reflectance.g, side > 0 ? 0.9f : 0.1f,
                1e-5f);
  }
  EXPECT_EQ(patches.met_by({10, 10, 0}, {1, 0, 0}), Patches::kNone);
}

TEST(CutLight, IsThatOfTheReferenceUnderPlanesAndSlabs) {
  const CutLight light = hollow(studio(), Vec3(0));
  const Vec3 oblique = glm::normalize(Vec3(0.4f, -0.3f, -0.8f));
  const std::vector<std::vector<Plane>> cuts = {{kLower},
                                                {{oblique, -12}},
                                                {{oblique, -25}, {-oblique, -8}},
                                                {kLower, {glm::normalize(Vec3(-1, 0.2f, 0)), -15}}};
  double squares = 0;
  double values = 0;
  for (const std::vector<Plane>& planes : cuts) {
    const std::vector<Vec3> solution = light.solve(planes, 0);
    for (int i = 0; i < 80; ++i) {
      const Vec3 normal = fibonacci_sphere(i, 80);
      const Vec3 at = -kRadius * normal;
      const bool kept = std::ranges::all_of(
          planes, [&](const Plane& plane) { return plane.signed_distance(at) > 8; });
      if (!kept) {
        continue;
      }
      const glm::dvec3 exact = reference(studio(), planes, glm::dvec3(normal));
      const glm::dvec3 error = glm::dvec3(at_bowl(light, solution, normal)) - exact;
      EXPECT_LT(glm::length(error), 0.25) << glm::length(exact);  // where a shadow's edge lies
      squares += glm::dot(error, error);
      values += 3;
    }
  }
  ASSERT_GT(values, 100);
  EXPECT_LT(std::sqrt(squares / values), 0.03);
}

TEST(CutLight, AClosedHollowIsDarkAndAnOpenedOneIsNot) {
  const CutLight light = hollow(white_sky(), Vec3(0.8f));
  const std::vector<Vec3> closed = light.solve({}, 6);
  const std::vector<Vec3> opened = light.solve({&kLower, 1}, 6);
  for (const Vec3& normal : bowl_normals()) {
    EXPECT_LT(at_bowl(light, closed, normal).g, 1e-6f);
    EXPECT_GT(at_bowl(light, opened, normal).g, 0.4f);
  }
}

// Of the hemisphere above any point of a half bowl the opening has half, and the bowl the rest: in
// a sphere the form factor from any point of the wall to a part of it is that part's share of the
// sphere's area. So all of the bowl radiates E = 1/2 + albedo·E/2, times the sky.
TEST(CutLight, ABowlIsLitAsTheTheoryOfTheIntegratingSphereSays) {
  const Vec3 albedo(0.8f, 0.5f, 0);
  const CutLight light = hollow(white_sky(), albedo);
  const std::vector<Vec3> bounced = light.solve({&kLower, 1}, 12);
  Vec3 mean(0);
  float count = 0;
  for (const Vec3& normal : bowl_normals()) {
    mean += at_bowl(light, bounced, normal);
    ++count;
  }
  mean /= count;
  for (int k = 0; k < 3; ++k) {
    const float exact = 0.5f / (1 - 0.5f * albedo[k]);
    EXPECT_NEAR(mean[k], exact, 0.03f * exact) << k;
  }
  // Going on from a solution of another plane ends at the same.
  const Plane other{{0, 0, -1}, -4};
  const std::vector<Vec3> elsewhere = light.solve({&other, 1}, 12);
  const std::vector<Vec3> again = light.solve({&kLower, 1}, 12, elsewhere);
  for (size_t i = 0; i < again.size(); ++i) {
    EXPECT_NEAR(again[i].r, bounced[i].r, 0.01f);
  }
}

TEST(CutLight, IsTheSameOnOneThread) {
  const auto solve = [] { return hollow(studio(), Vec3(0.7f)).solve({&kLower, 1}, 4); };
  const std::vector<Vec3> many = solve();
  set_thread_count(1);
  const std::vector<Vec3> one = solve();
  set_thread_count(0);
  EXPECT_EQ(many, one);
}

// As skin above the skull: cells that hold some of both would be dark in the light.
TEST(Patches, AreOfTheOutermostOfSurfacesThatLookTheSameWay) {
  const Vec3 normal = glm::normalize(Vec3(0.3f, 0.2f, 1));
  Vec3 u;
  Vec3 v;
  orthonormal_basis(normal, u, v);
  std::vector<SurfacePoint> points;
  for (int i = -40; i <= 40; ++i) {
    for (int j = -40; j <= 40; ++j) {
      const Vec3 at = 0.5f * (static_cast<float>(i) * u + static_cast<float>(j) * v);
      points.push_back({at - 2.0f * normal, normal, Vec3(0.1f)});
      points.push_back({at, normal, Vec3(0.9f)});
    }
  }
  const Patches patches(make_grid(), points);
  int both = 0;  // cells that hold some of the outer surface
  for (const SurfacePoint& patch : patches.all()) {
    const float depth = -glm::dot(patch.position, normal);
    EXPECT_TRUE(depth < 0.01f || depth > 1.99f) << depth;
    both += depth < 0.01f ? 1 : 0;
  }
  EXPECT_GT(both, 60);
}

}  // namespace
}  // namespace clipgs
