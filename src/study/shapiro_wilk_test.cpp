#include "study/shapiro_wilk.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/error.h"
#include "core/random.h"

namespace clipgs {
namespace {

struct ShapiroReference {
  std::vector<double> values;
  double w;
  double p;
};

// shapiro.test of R 4.2; the first are the weights of men of Shapiro & Wilk (1965).
std::vector<ShapiroReference> references() {
  std::vector<ShapiroReference> all = {
      {{148, 154, 158, 160, 161, 162, 166, 170, 182, 195, 236},
       0.788814694835388,
       0.006703814056503},
      {{1, 2, 4}, 0.964285714285714, 0.636886845028963},
      {{1, 2, 3, 7}, 0.886912377977182, 0.368999332891924},
      {{1, 2, 3, 4, 9}, 0.866960710872609, 0.254333839455088},
      {{1.5, 2, 2.5, 3, 8, 9}, 0.797117253960579, 0.055358167416911},
      {{0.1, 0.2, 0.35, 0.4, 0.9, 1.1, 1.15, 1.2, 2, 2.5, 7, 9},
       0.701376966733757,
       0.000868780836688},
      {{2, 1, 3, 1, -1, 2, 4, 0, 1, 3, 2, -2}, 0.960061597046340, 0.784709028847680},
      {{0, 1, 1, 1, 1, 1, 2, 2, 2, 2}, 0.802176604212506, 0.015408869102444},
      {{}, 0.955582687652477, 0.058091862700932},
      {{}, 0.899290108728776, 0.001823048746276}};
  for (int i = 1; i <= 50; ++i) {
    all[8].values.push_back(i);
  }
  for (int i = 1; i <= 40; ++i) {
    all[9].values.push_back(i * i);
  }
  return all;
}

TEST(ShapiroWilk, IsThatOfR) {
  for (const ShapiroReference& reference : references()) {
    const ShapiroWilk test = shapiro_wilk(reference.values).value();
    EXPECT_NEAR(test.w, reference.w, 1e-12) << reference.values.size();
    EXPECT_NEAR(test.p, reference.p, 1e-10) << reference.values.size();
  }
}

TEST(ShapiroWilk, NeitherOrderNorUnitMatters) {
  for (const ShapiroReference& reference : references()) {
    std::vector<double> other = reference.values;
    std::ranges::reverse(other);
    for (double& value : other) {
      value = 3 - 1e-3 * value;
    }
    const ShapiroWilk before = shapiro_wilk(reference.values).value();
    const ShapiroWilk after = shapiro_wilk(other).value();
    EXPECT_NEAR(after.w, before.w, 1e-10);
    EXPECT_NEAR(after.p, before.p, 1e-8);
  }
}

// Of samples that are normal one in twenty has p < .05, at each of the sizes that Royston treats
// differently; within four standard errors of 2000 samples.
TEST(ShapiroWilk, IsWrongOfNormalValuesAsOftenAsItSays) {
  constexpr int kSamples = 2000;
  for (const size_t n : {5U, 10U, 20U, 100U}) {
    Rng rng(n);
    int refused = 0;
    for (int i = 0; i < kSamples; ++i) {
      std::vector<double> values(n);
      for (double& value : values) {
        value = rng.normal();
      }
      refused += shapiro_wilk(values).value().p < 0.05 ? 1 : 0;
    }
    EXPECT_NEAR(refused / static_cast<double>(kSamples), 0.05, 0.0195) << n;
  }
}

TEST(ShapiroWilk, SkewedSamplesAreFound) {
  Rng rng(3);
  std::vector<double> values(kMostForShapiroWilk);
  for (double& value : values) {
    value = std::exp(rng.normal());
  }
  EXPECT_LT(shapiro_wilk(values).value().p, 1e-9);
}

TEST(ShapiroWilk, ThreeEvenlySpacedValuesFitPerfectly) {
  const ShapiroWilk test = shapiro_wilk(std::vector<double>{1, 2, 3}).value();
  EXPECT_NEAR(test.w, 1, 1e-12);
  EXPECT_NEAR(test.p, 1, 1e-5);
}

TEST(ShapiroWilk, RefusesTooFewTooManyAndNoneOfEqualValues) {
  EXPECT_THROW(shapiro_wilk(std::vector<double>{1, 2}), Error);
  EXPECT_THROW(shapiro_wilk(std::vector<double>(kMostForShapiroWilk + 1, 1.0)), Error);
  EXPECT_THROW(shapiro_wilk(std::vector<double>{1, 2, std::nan("")}), Error);
  EXPECT_FALSE(shapiro_wilk(std::vector<double>{4, 4, 4, 4}));
}

}  // namespace
}  // namespace clipgs
