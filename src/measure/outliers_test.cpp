#include "measure/outliers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace clipgs {
namespace {

using Values = std::vector<std::optional<double>>;

TEST(Outliers, AreFarFromTheMedianInRobustDeviations) {
  // Median 5, deviations 4 3 2 1 0 1 2 3 95: their median 2.
  const Values scores = robust_scores(Values{1, 2, 3, 4, 5, 6, 7, 8, 100}, 0);
  EXPECT_NEAR(*scores[8], 95 / (1.4826 * 2), 1e-9);
  EXPECT_NEAR(*scores[0], -4 / (1.4826 * 2), 1e-9);
  EXPECT_EQ(*scores[4], 0);
}

TEST(Outliers, WhereHalfAreTheSameTheMeanDeviationCounts) {
  const Values scores = robust_scores(Values{5, 5, 5, 5, 5, 5, 5, 14}, 0);
  EXPECT_NEAR(*scores[7], 9 / (1.2533 * 9 / 8), 1e-9);
}

TEST(Outliers, SmallDifferencesAreNone) {
  const Values values{30, 30.01, 30.02, 29.99, 30, 30.01, 30, 30.4};
  EXPECT_GT(*robust_scores(values, 0)[7], kStandsOut);
  EXPECT_LT(*robust_scores(values, 0.5)[7], 1);
}

TEST(Outliers, FewOrMissingValuesHaveNone) {
  for (const std::optional<double>& score : robust_scores(Values{1, 2, 3, 400}, 0)) {
    EXPECT_FALSE(score);
  }
  Values values(9, 1.0);
  values[3] = std::nullopt;
  EXPECT_FALSE(robust_scores(values, 1)[3]);
  EXPECT_EQ(robust_scores(values, 1)[4], 0.0);
  EXPECT_FALSE(median_of(Values(3)));
  EXPECT_EQ(median_of(Values{3, std::nullopt, 1, 2, 8}), 2.5);
}

}  // namespace
}  // namespace clipgs
