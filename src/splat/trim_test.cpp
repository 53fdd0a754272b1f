#include "splat/trim.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/random.h"

namespace clipgs {
namespace {

/// Gaussians of every shape and direction around the origin.
Gaussians random_cloud(size_t count) {
  Gaussians cloud(count, 1);
  Rng rng(4);
  for (size_t i = 0; i < count; ++i) {
    for (int p = 0; p < cloud.planes(); ++p) {
      cloud.plane(p)[i] = static_cast<float>(rng.below(2000)) / 1000 - 1;
    }
    for (int a = 0; a < 3; ++a) {
      cloud.plane(Gaussians::kMean + a)[i] *= 10;
    }
  }
  return cloud;
}

TEST(Trim, LeavesNothingBeyondThePlanes) {
  const Gaussians cloud = random_cloud(500);
  const std::array planes = {Plane{glm::normalize(Vec3(1, 2, -1)), -2}, Plane{{0, 0, 1}, -4}};
  const Gaussians kept = trim(cloud, planes);
  EXPECT_GT(kept.size(), 100);
  EXPECT_LT(kept.size(), cloud.size());
  for (size_t i = 0; i < kept.size(); ++i) {
    for (const Plane& plane : planes) {
      const float deviation = std::sqrt(glm::dot(plane.normal, kept.covariance(i) * plane.normal));
      EXPECT_GT(plane.signed_distance(kept.mean(i)), 0);
      // Where planes meet, a little beyond the first after it is pressed by the second.
      EXPECT_GE(plane.signed_distance(kept.mean(i)), 1.9f * deviation - 0.05f);
    }
  }
}

TEST(Trim, IsWhatPressingTheCovarianceSays) {
  Gaussians cloud(1, 0);
  cloud.plane(Gaussians::kMean)[0] = 3;  // mm behind the plane x ≥ 0
  cloud.plane(Gaussians::kLogScale)[0] = std::log(4.0f);
  cloud.plane(Gaussians::kLogScale + 1)[0] = std::log(2.0f);
  cloud.plane(Gaussians::kRotation)[0] = 1;
  const Gaussians kept = trim(cloud, std::array{Plane{{1, 0, 0}, 0}});
  const Mat3 covariance = kept.covariance(0);
  EXPECT_NEAR(covariance[0][0], 1, 1e-4f);  // three deviations reach the plane
  EXPECT_NEAR(covariance[1][1], 4, 1e-4f);
  EXPECT_NEAR(covariance[2][2], 1, 1e-4f);
  EXPECT_NEAR(covariance[0][1], 0, 1e-5f);
}

TEST(Trim, LeavesAloneWhatNoPlaneMeets) {
  const Gaussians cloud = random_cloud(50);
  const Gaussians kept = trim(cloud, std::array{Plane{{0, 1, 0}, -1000}});
  EXPECT_EQ(kept.data(), cloud.data());
  EXPECT_EQ(trim(cloud, {}).data(), cloud.data());
}

}  // namespace
}  // namespace clipgs
