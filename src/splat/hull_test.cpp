#include "splat/hull.h"

#include <gtest/gtest.h>

#include "splat/test_scene.h"

namespace clipgs {
namespace {

TEST(Hull, HoldsEverySplatThatIsSeenAndFitsABall) {
  const Vec3 center(10, -20, 1200);
  constexpr float kRadius = 120;
  Gaussians cloud = random_gaussians(20000, 0, 3, center, kRadius);
  // A faint one far away is not part of the body.
  cloud.plane(Gaussians::kMean)[0] = 5000;
  cloud.plane(Gaussians::kOpacity)[0] = -5;
  const Hull hull(cloud);
  for (size_t k = 0; k < Hull::kDirections; ++k) {
    const Vec3& direction = Hull::directions()[k];
    EXPECT_NEAR(glm::length(direction), 1, 1e-5f);
    const float middle = glm::dot(direction, center);
    EXPECT_NEAR(hull.low[k], middle - kRadius, 0.15f * kRadius);
    EXPECT_NEAR(hull.high[k], middle + kRadius, 0.15f * kRadius);
    for (size_t i = 1; i < cloud.size(); ++i) {
      const float along = glm::dot(direction, cloud.mean(i));
      if (cloud.opacity(i) > 0.1f) {
        ASSERT_GE(along, hull.low[k]);
        ASSERT_LE(along, hull.high[k]);
      }
    }
  }
  // No two directions are much alike.
  for (size_t a = 0; a < Hull::kDirections; ++a) {
    for (size_t b = a + 1; b < Hull::kDirections; ++b) {
      EXPECT_LT(std::abs(glm::dot(Hull::directions()[a], Hull::directions()[b])), 0.99f) << a << b;
    }
  }
}

}  // namespace
}  // namespace clipgs
