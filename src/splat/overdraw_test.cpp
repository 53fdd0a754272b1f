#include "splat/overdraw.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/camera.h"
#include "splat/projection.h"
#include "splat/render.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

constexpr float kRadius = 30;

TEST(Overdraw, IsTheAreaInWhichGaussiansAreBlended) {
  // Round ones look the same from everywhere: their boxes are circles' then.
  Gaussians round = random_gaussians(200, 0, 7, Vec3(0), kRadius);
  for (size_t i = 0; i < round.size(); ++i) {
    for (int a = 1; a < 3; ++a) {
      round.plane(Gaussians::kLogScale + a)[i] = round.plane(Gaussians::kLogScale)[i];
    }
  }
  // From so far that perspective and the blur of a pixel are nothing.
  constexpr float kDistance = 1e5f;
  const Camera camera = look_at({kDistance, 0, 0}, Vec3(0), {0, 0, 1}, 4096, 4096, 2e-3f);
  const float pixels = camera.fx / kDistance;  // a mm
  double area = 0;
  for (size_t i = 0; i < round.size(); ++i) {
    Splat splat;
    if (project(round, i, camera, {}, {}, splat, nullptr)) {
      area += M_PI * splat.extent_x * splat.extent_y / (pixels * pixels);
    }
  }
  const double expected = area / (M_PI * kRadius * kRadius);
  EXPECT_NEAR(overdraw(round, kRadius), expected, 0.01 * expected);
}

TEST(Overdraw, CoverIsTheSumOfAlpha) {
  Gaussians one(1, 0);
  for (int a = 0; a < 3; ++a) {
    one.plane(Gaussians::kLogScale + a)[0] = std::log(2.0f);
  }
  one.plane(Gaussians::kRotation)[0] = 1;
  one.plane(Gaussians::kOpacity)[0] = 0.5f;
  // 10 px a mm, so that a pixel's blur is nothing.
  const Camera camera = look_at({1000, 0, 0}, Vec3(0), {0, 0, 1}, 256, 256, 2 * std::atan(0.0128f));
  const Image picture = render(one, camera, std::nullopt, ClipOperator::kExact);
  double sum = 0;
  for (size_t i = 0; i < picture.pixels(); ++i) {
    sum += picture.data[4 * i + 3];
  }
  const double pixels = camera.fx / 1000;
  // What is fainter than 1/255 is not drawn.
  EXPECT_NEAR(sum / (pixels * pixels), mean_cover(one, 0), 0.01 * mean_cover(one, 0));
}

TEST(Overdraw, GradientIsThatOfFiniteDifferences) {
  Gaussians gaussians = random_gaussians(20, 0, 3, Vec3(0), kRadius);
  gaussians.plane(Gaussians::kOpacity)[0] = -9;  // too faint to be drawn
  Gaussians gradients = gaussians.like(gaussians.size());
  constexpr float kWeight = 0.7f;
  for (size_t i = 0; i < gaussians.size(); ++i) {
    add_overdraw_gradient(gaussians, i, kRadius, kWeight, gradients);
  }
  constexpr float kStep = 1e-2f;
  for (int p = 0; p < gaussians.planes(); ++p) {
    for (size_t i = 0; i < gaussians.size(); ++i) {
      Gaussians up = gaussians;
      Gaussians down = gaussians;
      up.plane(p)[i] += kStep;
      down.plane(p)[i] -= kStep;
      const double slope =
          kWeight * (overdraw(up, kRadius) - overdraw(down, kRadius)) / (2 * kStep);
      EXPECT_NEAR(gradients.plane(p)[i], slope, 1e-3 * std::abs(slope) + 1e-7) << p << " " << i;
    }
  }
}

}  // namespace
}  // namespace clipgs
