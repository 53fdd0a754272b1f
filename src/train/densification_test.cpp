#include "train/densification.h"

#include <algorithm>
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

/// No Gaussian is needed more than another.
std::vector<float> even(const Gaussians& g) { return std::vector<float>(g.size(), 1.0f); }

TEST(Densification, HalvesLieSideBySideAndLookLikeTheWhole) {
  Gaussians g = row_of(2, 0.001f);
  g.plane(Gaussians::kOpacity)[0] = logit(0.7f);
  g.plane(Gaussians::kLogScale + 1)[0] = std::log(8.0f);  // the longest axis
  // A quarter turn about z takes local y to −x.
  g.plane(Gaussians::kRotation + 3)[0] = 1;
  const Mat3 whole = g.covariance(0);
  const Camera camera = frame_sphere({{0, 0, 0}, 30}, View{}, 64, 64);
  const Image before = Rasterizer().forward(g, camera, std::nullopt, {});
  Adam adam(g);
  std::vector<float> need = {3, 5};
  EXPECT_EQ(relocate_dead(g, adam, need, Rng(1)).targets, std::vector<std::uint32_t>{1});
  EXPECT_EQ(need, (std::vector<float>{1.5f, 1.5f}));
  EXPECT_NEAR(g.mean(0).x, -g.mean(1).x, 1e-5f);
  EXPECT_NEAR(std::abs(g.mean(0).x), 5.6f, 1e-5f);
  EXPECT_NEAR(g.mean(0).y, 0, 1e-5f);
  // Within and between the halves, the variance of the whole.
  const float between = g.mean(0).x * g.mean(0).x;
  EXPECT_NEAR(g.covariance(0)[0][0] + between, whole[0][0], 1e-3f);
  EXPECT_NEAR(g.covariance(1)[1][1], whole[1][1], 1e-3f);
  const Image after = Rasterizer().forward(g, camera, std::nullopt, {});
  double total_before = 0;
  double total_after = 0;
  for (size_t i = 3; i < before.data.size(); i += 4) {
    EXPECT_NEAR(after.data[i], before.data[i], 0.15);
    total_before += before.data[i];
    total_after += after.data[i];
  }
  EXPECT_NEAR(total_after / total_before, 1, 0.15);
}

TEST(Densification, SplitsWhereThereIsNeed) {
  Gaussians g = row_of(400, 0.5f);
  for (size_t i = 0; i < 100; ++i) {
    g.plane(Gaussians::kOpacity)[i] = logit(0.001f);
  }
  Adam adam(g);
  std::vector<float> need = even(g);
  need[350] = 1e6f;
  need[360] = 1e4f;
  const Copies made = relocate_dead(g, adam, need, Rng(1));
  EXPECT_EQ(std::ranges::count(made.sources, 350U), Densification::kMostSplits);
  EXPECT_GT(std::ranges::count(made.sources, 360U), 0);
  EXPECT_EQ(made.targets.size(), made.sources.size());
  std::vector<float> none(g.size(), 0.0f);  // then anywhere
  EXPECT_EQ(grow(g, adam, none, 410, Rng(1)).targets.size(), 10U);
}

// As where most have died at once, and one of the rest is needed by far the most: it would give
// halves away until it is too small for numbers.
TEST(Densification, SplitsOneNoMoreThanAFewTimesAtOnce) {
  Gaussians g = row_of(1001, 0.001f);
  g.plane(Gaussians::kOpacity)[7] = logit(0.9f);
  Adam adam(g);
  std::vector<float> need = even(g);
  EXPECT_EQ(relocate_dead(g, adam, need, Rng(1)).targets.size(), 8U);
  EXPECT_GT(grow(g, adam, need, 2000, Rng(1)).targets.size(), 40U);
  need[7] = 1e9f;
  EXPECT_LT(grow(g, adam, need, 2000, Rng(1)).targets.size(), 20U);
  for (size_t i = 0; i < g.size(); ++i) {
    for (int a = 0; a < 3; ++a) {
      EXPECT_GT(g.scale(i)[a], 0.05f) << i;
    }
  }
}

TEST(Densification, GrowthStopsAtTheBudget) {
  Gaussians g = row_of(100, 0.5f);
  Adam adam(g);
  std::vector<float> need = even(g);
  EXPECT_EQ(grow(g, adam, need, 103, Rng(1)).targets.size(), 3U);
  EXPECT_EQ(g.size(), 103U);
  EXPECT_EQ(adam.updates().size(), 103U);
  EXPECT_EQ(need.size(), 103U);
  EXPECT_EQ(grow(g, adam, need, 103, Rng(2)).targets.size(), 0U);
  Gaussians large = row_of(100, 0.5f);
  Adam large_adam(large);
  std::vector<float> large_need = even(large);
  EXPECT_EQ(grow(large, large_adam, large_need, 1000, Rng(1)).targets.size(), 5U);
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
  std::vector<float> need = even(g);
  EXPECT_EQ(relocate_dead(g, adam, need, Rng(1)).targets.size(), 0U);
}

}  // namespace
}  // namespace clipgs
