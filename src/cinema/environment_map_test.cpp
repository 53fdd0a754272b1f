#include "cinema/environment_map.h"

#include <gtest/gtest.h>
#include <numbers>

#include "cinema/test_scenes.h"
#include "core/random.h"

namespace clipgs {
namespace {

Vec3 random_direction(Rng& rng) {
  return glm::normalize(Vec3(rng.normal(), rng.normal(), rng.normal()));
}

TEST(EnvironmentMap, DirectionsComeBack) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 direction = random_direction(rng);
    const Vec2 at = EnvironmentMap::square_from_direction(direction);
    ASSERT_TRUE(at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1);
    ASSERT_LT(glm::length(EnvironmentMap::direction_from_square(at) - direction), 1e-5f);
  }
}

TEST(EnvironmentMap, ShowsThePanorama) {
  const Mat3 frame(glm::angleAxis(0.7f, glm::normalize(Vec3(1, 2, 3))));
  Image panorama(64, 32, 3);
  panorama.at(32, 16)[0] = 1;  // anterior
  panorama.at(48, 16)[1] = 1;  // the patient's left
  for (int x = 0; x < 64; ++x) {
    panorama.at(x, 0)[2] = 1;  // superior
  }
  const EnvironmentMap map(panorama, 0, frame);
  const auto toward = [&](const Vec3& world) {
    return map.radiance(frame * glm::normalize(world));
  };
  EXPECT_GT(toward({-0.05f, 1, -0.05f}).x, 0.9f);
  EXPECT_GT(toward({-1, -0.05f, -0.05f}).y, 0.9f);
  EXPECT_GT(toward({0.04f, -0.025f, 1}).z, 0.9f);
  EXPECT_EQ(toward({0, -1, 0}), Vec3(0));
  // Turned towards the right, what was in front lies there.
  const EnvironmentMap turned(panorama, 0.5f * std::numbers::pi_v<float>, frame);
  EXPECT_GT(turned.radiance(frame * glm::normalize(Vec3(1, 0.05f, -0.05f))).x, 0.9f);
}

// Whatever the map shows, directions are drawn with the density that it claims.
TEST(EnvironmentMap, DensityIsThatOfTheAliasTable) {
  const EnvironmentMap map(test::panorama(), 0.3f, Mat3(1));
  const EnvironmentMap::Tables& tables = map.tables();
  const size_t texels = tables.keep.size();
  std::vector<double> drawn(texels, 0.0);
  for (size_t i = 0; i < texels; ++i) {
    drawn[i] += static_cast<double>(tables.keep[i]);
    drawn[static_cast<size_t>(tables.alias[i])] += 1 - static_cast<double>(tables.keep[i]);
  }
  for (size_t i = 0; i < texels; ++i) {
    ASSERT_NEAR(drawn[i] / 4, static_cast<double>(tables.density[i]),
                1e-3 + 1e-4 * static_cast<double>(tables.density[i]));
  }
}

TEST(EnvironmentMap, FaceRadianceIsAnIntegral) {
  const EnvironmentMap map(test::panorama(), 0, Mat3(1));
  Rng rng(5);
  const Vec3 normal = glm::normalize(Vec3(0.3f, -0.5f, 0.6f));
  glm::dvec3 face(0);
  constexpr int kDirections = 400000;
  for (int i = 0; i < kDirections; ++i) {
    const Vec3 direction = random_direction(rng);
    const glm::dvec3 light(map.radiance(direction));
    face += light * static_cast<double>(4 * std::max(0.0f, glm::dot(direction, normal))) /
            static_cast<double>(kDirections);
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(static_cast<double>(map.face_radiance(normal)[c]), face[c], 0.02 * face[c]);
  }
}

}  // namespace
}  // namespace clipgs
