#include "volume/volume.h"

#include <gtest/gtest.h>

#include "volume/phantom.h"

namespace clipgs {
namespace {

Volume ramp() {
  Volume volume;
  volume.dims = {4, 5, 6};
  volume.spacing = {1, 2, 3};
  volume.direction = Mat3(glm::mat3_cast(glm::angleAxis(0.2f, glm::normalize(Vec3(1, 2, 3)))));
  volume.origin = {10, -20, 30};
  for (int z = 0; z < 6; ++z) {
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 4; ++x) {
        volume.values.unpack().push_back(static_cast<float>(x + 10 * y + 100 * z));
      }
    }
  }
  return volume;
}

TEST(Volume, WorldAndIndexAreInverse) {
  const Volume volume = ramp();
  const Vec3 index(1.25f, 3.5f, 0.75f);
  const Vec3 back = volume.index_from_world(volume.world_from_index(index));
  EXPECT_LT(glm::length(back - index), 1e-4f);
}

TEST(Volume, SampleIsTrilinear) {
  const Volume volume = ramp();
  const Vec3 index(1.25f, 3.5f, 4.75f);
  EXPECT_NEAR(volume.sample(volume.world_from_index(index)), 1.25f + 35 + 475, 1e-2f);
}

TEST(Volume, SampleOutsideTakesTheNearestVoxel) {
  const Volume volume = ramp();
  EXPECT_NEAR(volume.sample(volume.world_from_index({-9, 2, 99})), 0 + 20 + 500, 1e-2f);
  EXPECT_NEAR(volume.sample(volume.world_from_index({3, 4, 5})), 3 + 40 + 500, 1e-2f);
}

TEST(Volume, BoundsHoldEveryCorner) {
  const Volume volume = ramp();
  const Box box = volume.bounds();
  for (const Vec3 corner : {Vec3(0, 0, 0), Vec3(3, 4, 5), Vec3(3, 0, 5), Vec3(0, 4, 0)}) {
    const Vec3 p = volume.world_from_index(corner);
    EXPECT_TRUE(glm::all(glm::lessThanEqual(box.min, p + 1e-3f)));
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(box.max, p - 1e-3f)));
  }
}

TEST(Ball, HasTheAnalyticVolume) {
  const Volume ball = make_ball(48, 20, 1, 0);
  double sum = 0;
  for (const float v : ball.values.all()) {
    sum += v;
  }
  EXPECT_NEAR(sum, 4.0 / 3 * 3.14159265 * 20 * 20 * 20, 40);
  EXPECT_EQ(ball.sample({0, 0, 0}), 1);
  EXPECT_EQ(ball.sample({0, 0, 23}), 0);
  EXPECT_NEAR(ball.sample({20, 0, 0}), 0.5f, 0.03f);
}

}  // namespace
}  // namespace clipgs
