#include "study/descriptives.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "core/error.h"

namespace clipgs {
namespace {

const std::vector<double> kScores = {62.5, 70, 85, 92.5, 55, 77.5, 80};

// References: quantile and t.test of R 4.2.
TEST(Descriptives, AreThoseOfR) {
  const Descriptives all = describe(kScores);
  EXPECT_EQ(all.n, 7);
  EXPECT_NEAR(all.mean, 74.64285714285714, 1e-12);
  EXPECT_NEAR(all.sd.value(), 13.024701806293193, 1e-12);
  EXPECT_EQ(all.q1, 66.25);
  EXPECT_EQ(all.median, 77.5);
  EXPECT_EQ(all.q3, 82.5);
  EXPECT_EQ(all.iqr(), 16.25);
  EXPECT_EQ(all.min, 55);
  EXPECT_EQ(all.max, 92.5);
  EXPECT_NEAR(all.mean_ci.value().low, 62.59701705419657, 1e-11);
  EXPECT_NEAR(all.mean_ci.value().high, 86.68869723151771, 1e-11);
}

TEST(Descriptives, DoNotDependOnTheOrder) {
  std::vector<double> shuffled = {0.1, 0.7, 1e9, 0.3, -5, 2e-3, 1e9 + 1};
  const Descriptives before = describe(shuffled);
  std::ranges::reverse(shuffled);
  std::swap(shuffled[1], shuffled[4]);
  const Descriptives after = describe(shuffled);
  EXPECT_EQ(before.mean, after.mean);
  EXPECT_EQ(before.sd, after.sd);
  EXPECT_EQ(before.q1, after.q1);
}

TEST(Descriptives, OneValueHasNoSpread) {
  const Descriptives one = describe(std::vector<double>{3});
  EXPECT_EQ(one.mean, 3);
  EXPECT_EQ(one.median, 3);
  EXPECT_FALSE(one.sd);
  EXPECT_FALSE(one.mean_ci);
}

TEST(Descriptives, EqualValuesHaveASpreadOfNothing) {
  EXPECT_EQ(describe(std::vector<double>{0.1, 0.1, 0.1}).sd, 0);
}

TEST(Descriptives, RefuseNoValuesAndInfinity) {
  EXPECT_THROW(describe({}), Error);
  EXPECT_THROW(describe(std::vector<double>{1, std::numeric_limits<double>::quiet_NaN()}), Error);
  EXPECT_THROW(describe(std::vector<double>{1, std::numeric_limits<double>::infinity()}), Error);
}

}  // namespace
}  // namespace clipgs
