#include "train/densification.h"

#include <cmath>
#include <gtest/gtest.h>

#include "splat/rasterizer.h"

namespace clipgs {
namespace {

float logit(float p) { return std::log(p / (1 - p)); }

Gaussians row_of(size_t count, float opacity) {
  Gaussians g(count, 0);
  for (size_t i = 0; i < count; ++i) {
    g.plane(Gaussians::kMean)[i] = 30.0f * static_cast<float>(i);
    g.plane(Gaussians::kRotation)[i] = 1;
    g.plane(Gaussians::kOpacity)[i] = logit(opacity);
    for (int a = 0; a < 3; ++a) {
      g.plane(Gaussians::kLogScale + a)[i] = std::log(4.0f);
    }
  }
  return g;
}

TEST(Densification, RelocationKeepsThePictureAndRevivesTheDead) {
  // One living Gaussian, two dead ones far away: both must land on the living one, and the three
  // together must look like the one.
  Gaussians g = row_of(3, 0.001f);
  g.plane(Gaussians::kOpacity)[0] = logit(0.7f);
  const Camera camera = frame_sphere({{0, 0, 0}, 20}, View{}, 64, 64);
  Image before = Rasterizer().forward(g, camera, std::nullopt, {});
  Adam adam(g);
  EXPECT_EQ(relocate_dead(g, adam, Rng(1)).targets.size(), 2U);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(g.mean(i), Vec3(0));
    EXPECT_NEAR(g.opacity(i), 1 - std::cbrt(0.3f), 1e-5);
  }
  const Image after = Rasterizer().forward(g, camera, std::nullopt, {});
  double total_before = 0;
  double total_after = 0;
  for (size_t i = 3; i < before.data.size(); i += 4) {
    EXPECT_NEAR(after.data[i], before.data[i], 0.1);
    total_before += before.data[i];
    total_after += after.data[i];
  }
  EXPECT_NEAR(total_after / total_before, 1, 0.1);
}

TEST(Densification, GrowthStopsAtTheBudget) {
  Gaussians g = row_of(100, 0.5f);
  Adam adam(g);
  EXPECT_EQ(grow(g, adam, 103, Rng(1)).targets.size(), 3U);
  EXPECT_EQ(g.size(), 103U);
  EXPECT_EQ(adam.updates().size(), 103U);
  EXPECT_EQ(grow(g, adam, 103, Rng(2)).targets.size(), 0U);
  Gaussians large = row_of(100, 0.5f);
  Adam large_adam(large);
  EXPECT_EQ(grow(large, large_adam, 1000, Rng(1)).targets.size(), 5U);
}

TEST(Densification, NoiseMovesOnlyTheFaint) {
  Gaussians g = row_of(2, 0.9f);
  g.plane(Gaussians::kOpacity)[1] = logit(0.002f);
  const Gaussians before = g;
  add_noise(g, 1e-6f, 1, 1);
  EXPECT_EQ(g.mean(0), before.mean(0));
  EXPECT_NE(g.mean(1), before.mean(1));
}

TEST(Densification, AllDeadChangesNothing) {
  Gaussians g = row_of(4, 0.001f);
  Adam adam(g);
  EXPECT_EQ(relocate_dead(g, adam, Rng(1)).targets.size(), 0U);
}

}  // namespace
}  // namespace clipgs
