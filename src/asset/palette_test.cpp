#include "asset/palette.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "asset/codebook.h"
#include "core/parallel.h"
#include "core/random.h"

namespace clipgs {
namespace {

double rms(const std::vector<float>& samples, const Codebook& codebook) {
  double sum = 0;
  for (const float x : samples) {
    const double e = x - codebook.values[codebook.nearest(x)];
    sum += e * e;
  }
  return std::sqrt(sum / static_cast<double>(samples.size()));
}

TEST(Codebook, NearestIsNearest) {
  Rng rng(1);
  std::vector<float> samples(5000);
  for (float& x : samples) {
    x = rng.normal();
  }
  const Codebook codebook = fit_codebook(samples);
  for (const float x : {-9.0f, -1.0f, 0.0f, 0.3f, 1.7f, 9.0f}) {
    float best = 1e9f;
    for (const float value : codebook.values) {
      best = std::min(best, std::abs(x - value));
    }
    EXPECT_EQ(std::abs(x - codebook.values[codebook.nearest(x)]), best);
  }
}

// High-resolution theory (Panter & Dite): the least error of N levels for a unit normal density is
// √(√3 π / 2) / N.
TEST(Codebook, ReachesTheTheoryForANormalDensity) {
  Rng rng(2);
  std::vector<float> samples(200000);
  for (float& x : samples) {
    x = rng.normal();
  }
  const double best = std::sqrt(std::sqrt(3.0) * 3.14159265 / 2) / 256;
  EXPECT_LT(rms(samples, fit_codebook(samples)), 1.03 * best);
}

TEST(Codebook, FewValuesAreKeptExactly) {
  std::vector<float> samples;
  for (int i = 0; i < 1000; ++i) {
    samples.push_back(std::sqrt(static_cast<float>(i % 256)));
  }
  EXPECT_EQ(rms(samples, fit_codebook(samples)), 0);
  EXPECT_EQ(fit_codebook({3.5f}).values[0], 3.5f);
  EXPECT_EQ(fit_codebook({}).values[255], 0.0f);
}

TEST(Codebook, OrderOfTheSamplesDoesNotMatter) {
  std::vector<float> samples;
  for (int i = 0; i < 3000; ++i) {
    samples.push_back(std::sin(static_cast<float>(i)));
  }
  const Codebook a = fit_codebook(samples);
  std::reverse(samples.begin(), samples.end());
  EXPECT_EQ(a.values, fit_codebook(samples).values);
}

std::vector<float> clustered_points(size_t count, size_t dimension, size_t clusters, float spread) {
  Rng rng(3);
  std::vector<float> centers(clusters * dimension);
  for (float& x : centers) {
    x = rng.normal();
  }
  std::vector<float> points(count * dimension);
  for (size_t i = 0; i < count; ++i) {
    for (size_t d = 0; d < dimension; ++d) {
      points[i * dimension + d] = centers[(i % clusters) * dimension + d] + spread * rng.normal();
    }
  }
  return points;
}

double mean_squared_error(const std::vector<float>& points, const Palette& palette) {
  double sum = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t label = palette.labels[i / palette.dimension];
    const double e =
        points[i] - palette.centroids[label * palette.dimension + i % palette.dimension];
    sum += e * e;
  }
  return sum / static_cast<double>(points.size());
}

std::vector<float> equal(size_t count) { return std::vector<float>(count, 1.0f); }

TEST(Palette, FindsClusters) {
  const auto points = clustered_points(8000, 9, 50, 0.01f);
  const Palette palette = fit_palette(points, equal(points.size() / 9), 9, 256);
  EXPECT_LE(palette.size(), 256u);
  EXPECT_LT(mean_squared_error(points, palette), 1.2e-4);
}

TEST(Palette, AsManyCentroidsAsPointsIsExact) {
  const auto points = clustered_points(100, 24, 100, 0.0f);
  const Palette palette = fit_palette(points, equal(points.size() / 24), 24, 65536);
  EXPECT_LE(palette.size(), 100u);
  EXPECT_LT(mean_squared_error(points, palette), 0.2);
}

TEST(Palette, ConstantPointsAndOnePoint) {
  const Palette same = fit_palette(std::vector<float>(9 * 500, 0.25f), equal(500), 9, 64);
  EXPECT_EQ(mean_squared_error(std::vector<float>(9 * 500, 0.25f), same), 0);
  const Palette one = fit_palette(std::vector<float>(45, 1.0f), equal(1), 45, 64);
  EXPECT_EQ(one.size(), 1u);
  EXPECT_EQ(one.labels, std::vector<std::uint16_t>{0});
}

TEST(Palette, WhatWeighsMoreIsCloserToItsCentroid) {
  const auto points = clustered_points(6000, 9, 6000, 1.0f);
  std::vector<float> weights(6000, 1.0f);
  std::fill(weights.begin(), weights.begin() + 1500, 50.0f);
  const auto error_of_the_first = [&](const Palette& palette) {
    return mean_squared_error({points.begin(), points.begin() + 1500 * 9}, palette);
  };
  const double alike = error_of_the_first(fit_palette(points, equal(6000), 9, 256));
  EXPECT_LT(error_of_the_first(fit_palette(points, weights, 9, 256)), 0.85 * alike);
}

TEST(Palette, ThreadsDoNotChangeIt) {
  const auto points = clustered_points(5000, 45, 300, 0.1f);
  set_thread_count(1);
  const Palette one = fit_palette(points, equal(points.size() / 45), 45, 512);
  set_thread_count(2);
  const Palette two = fit_palette(points, equal(points.size() / 45), 45, 512);
  set_thread_count(0);
  EXPECT_EQ(one.centroids, two.centroids);
  EXPECT_EQ(one.labels, two.labels);
}

}  // namespace
}  // namespace clipgs
