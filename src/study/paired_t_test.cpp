#include "study/paired_t.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "study/holm.h"
#include "study/sample_size.h"

namespace clipgs {
namespace {

const std::vector<double> kPairedDifferences = {2, 1, 3, 1, -1, 2, 4, 0, 1, 3, 2, -2};

/// P(T < t) of a noncentral t, from its definition (Z + δ) / √(χ²/df): the normal's probability
/// integrated over the density of s = √(χ²/df), by Simpson's rule.
double noncentral_t_below(double t, double df, double delta) {
  constexpr int kSteps = 20000;
  constexpr double kLast = 6;
  const double log_norm = std::log(2.0) + df / 2 * std::log(df / 2) - std::lgamma(df / 2);
  double sum = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double s = kLast * i / kSteps;
    const double density = std::exp(log_norm + (df - 1) * std::log(s) - df * s * s / 2);
    const double below = std::erfc((delta - t * s) / std::numbers::sqrt2) / 2;
    sum += (i == kSteps ? 1 : i % 2 == 1 ? 4 : 2) * density * below;
  }
  return sum * kLast / kSteps / 3;
}

// References: scipy.stats.ttest_1samp and scipy.stats.nct.
TEST(PairedT, IsThatOfScipy) {
  const PairedT test = paired_t(kPairedDifferences).value();
  EXPECT_NEAR(test.t, 2.6802375770419595, 1e-12);
  EXPECT_EQ(test.df, 11);
  EXPECT_NEAR(test.p, 0.021399110308157367, 1e-12);
  EXPECT_NEAR(test.mean, 16.0 / 12, 1e-14);
  EXPECT_NEAR(test.dz, 0.7737179432986628, 1e-12);
  EXPECT_NEAR(test.dz_ci.value().low, 0.11084707107499087, 1e-8);
  EXPECT_NEAR(test.dz_ci.value().high, 1.4102945761438404, 1e-8);
}

TEST(PairedT, TheIntervalOfTheEffectIsThatOfTheNoncentralT) {
  const PairedT test = paired_t(kPairedDifferences).value();
  const double root_n = std::sqrt(12.0);
  EXPECT_NEAR(noncentral_t_below(test.t, 11, test.dz_ci.value().low * root_n), 0.975, 1e-6);
  EXPECT_NEAR(noncentral_t_below(test.t, 11, test.dz_ci.value().high * root_n), 0.025, 1e-6);
}

TEST(PairedT, TheIntervalsHoldNothingExactlyWhereTheTestSaysSo) {
  for (const double shift : {-3.0, -2.0, -1.0, -0.2, 0.0, 0.3, 1.0}) {
    std::vector<double> moved = kPairedDifferences;
    for (double& d : moved) {
      d += shift;
    }
    const PairedT test = paired_t(moved).value();
    const bool holds = test.mean_ci.low <= 0 && test.mean_ci.high >= 0;
    EXPECT_EQ(holds, test.p >= 0.05) << shift;
    EXPECT_EQ(test.dz_ci.value().low <= 0 && test.dz_ci.value().high >= 0, holds) << shift;
  }
}

TEST(PairedT, TheOrderOfRowsDoesNotMatter) {
  std::vector<double> differences = kPairedDifferences;
  const PairedT before = paired_t(differences).value();
  std::ranges::reverse(differences);
  std::ranges::rotate(differences, differences.begin() + 5);
  EXPECT_EQ(paired_t(differences).value().t, before.t);
  EXPECT_EQ(paired_t(differences).value().dz, before.dz);
}

TEST(PairedT, SwappedModesFlipTheSignsAlone) {
  std::vector<double> swapped = kPairedDifferences;
  for (double& d : swapped) {
    d = -d;
  }
  const PairedT before = paired_t(kPairedDifferences).value();
  const PairedT after = paired_t(swapped).value();
  EXPECT_NEAR(after.t, -before.t, 1e-13);
  EXPECT_NEAR(after.p, before.p, 1e-14);
  EXPECT_NEAR(after.mean, -before.mean, 1e-14);
  EXPECT_NEAR(after.mean_ci.low, -before.mean_ci.high, 1e-13);
  EXPECT_NEAR(after.dz_ci.value().low, -before.dz_ci.value().high, 1e-8);
}

TEST(PairedT, LargeEffectsHaveAnIntervalOrNone) {
  for (const double mean : {10.0, 1e3, 1e6}) {
    std::vector<double> differences;
    for (int i = 0; i < 40; ++i) {
      differences.push_back(mean + i % 7);
    }
    const PairedT test = paired_t(differences).value();
    EXPECT_LT(test.p, 1e-10);
    if (test.dz_ci) {
      EXPECT_LT(test.dz_ci->low, test.dz);
      EXPECT_GT(test.dz_ci->high, test.dz);
    }
  }
}

TEST(PairedT, EqualDifferencesHaveNoT) {
  EXPECT_FALSE(paired_t(std::vector<double>{2, 2, 2}));
  EXPECT_THROW(paired_t(std::vector<double>{2}), Error);
  EXPECT_THROW(paired_t(std::vector<double>{2, std::nan("")}), Error);
}

// References: power.t.test(type = "paired", strict = TRUE) of R 4.2, rounded up; the powers by
// scipy's noncentral t.
TEST(SampleSize, IsThatOfR) {
  EXPECT_EQ(paired_t_sample_size(0.2), 199U);
  EXPECT_EQ(paired_t_sample_size(0.5), 34U);
  EXPECT_EQ(paired_t_sample_size(-0.5), 34U);
  EXPECT_EQ(paired_t_sample_size(0.8), 15U);
  EXPECT_EQ(paired_t_sample_size(0.945), 11U);
  EXPECT_EQ(paired_t_sample_size(1.5), 6U);
  EXPECT_EQ(paired_t_sample_size(0.05), 3142U);
  EXPECT_NEAR(paired_t_power(0.5, 34, 0.05), 0.8077775012792737, 1e-9);
  EXPECT_NEAR(paired_t_power(0.5, 20, 0.05), 0.564504418439038, 1e-9);
}

TEST(SampleSize, TheFewestPairsReachThePowerAndOneLessDoesNot) {
  for (const double dz : {0.1, 0.3, 0.7, 0.945, 1.5, 3.0}) {
    for (const double power : {0.6, 0.8, 0.95}) {
      const size_t n = paired_t_sample_size(dz, {power, 0.05}).value();
      EXPECT_GE(paired_t_power(dz, n, 0.05), power);
      if (n > 2) {
        EXPECT_LT(paired_t_power(dz, n - 1, 0.05), power);
      }
    }
  }
}

TEST(SampleSize, PowerIsThatOfTheNoncentralT) {
  const double critical = t_critical(19, 0.05);
  const double delta = 0.5 * std::sqrt(20.0);
  EXPECT_NEAR(
      paired_t_power(0.5, 20, 0.05),
      noncentral_t_below(-critical, 19, delta) + 1 - noncentral_t_below(critical, 19, delta), 1e-6);
}

TEST(SampleSize, WithoutAnEffectPowerIsAlpha) {
  EXPECT_NEAR(paired_t_power(0, 12, 0.05), 0.05, 1e-12);
  EXPECT_FALSE(paired_t_sample_size(0));
  EXPECT_FALSE(paired_t_sample_size(0.009));
  EXPECT_TRUE(paired_t_sample_size(0.01));
}

TEST(SampleSize, HugeEffectsNeedTwoPairs) {
  for (const double dz : {20.0, 50.0, 1e3, 1e9, -1e300}) {
    EXPECT_EQ(paired_t_sample_size(dz), 2U) << dz;
  }
  EXPECT_LE(paired_t_sample_size(1e9, {0.999, 1e-6}).value(), 5U);
  EXPECT_THROW(paired_t_sample_size(std::nan("")), Error);
  EXPECT_THROW(paired_t_sample_size(1e308 * 10), Error);
}

TEST(SampleSize, GrowsWithThePowerAndFallsWithTheEffect) {
  EXPECT_LT(paired_t_sample_size(0.5, {0.8, 0.05}), paired_t_sample_size(0.5, {0.9, 0.05}));
  EXPECT_LT(paired_t_sample_size(0.5, {0.8, 0.05}), paired_t_sample_size(0.5, {0.8, 0.01}));
  EXPECT_LT(paired_t_sample_size(0.6), paired_t_sample_size(0.5));
}

TEST(SampleSize, RanksNeedMoreByTheirEfficiency) {
  EXPECT_EQ(wilcoxon_sample_size(0.5), 36U);   // 34 · π/3 = 35.6
  EXPECT_EQ(wilcoxon_sample_size(0.2), 209U);  // 199 · π/3 = 208.4
  EXPECT_EQ(paired_t_sample_size(3), 4U);
  EXPECT_EQ(wilcoxon_sample_size(3), 6U);  // five pairs have an exact p of .0625 at best
  EXPECT_FALSE(wilcoxon_sample_size(0));
}

TEST(SampleSize, RefusesAnAimThatIsNone) {
  EXPECT_THROW(paired_t_sample_size(0.5, {1, 0.05}), Error);
  EXPECT_THROW(paired_t_sample_size(0.5, {0.04, 0.05}), Error);
  EXPECT_THROW(paired_t_sample_size(0.5, {0.8, 0}), Error);
}

// Reference: p.adjust(c(.01, .04, .03, .005), "holm") of R.
TEST(Holm, IsThatOfR) {
  const std::vector<double> corrected = holm(std::vector<double>{0.01, 0.04, 0.03, 0.005});
  ASSERT_EQ(corrected.size(), 4);
  EXPECT_NEAR(corrected[0], 0.03, 1e-15);
  EXPECT_NEAR(corrected[1], 0.06, 1e-15);
  EXPECT_NEAR(corrected[2], 0.06, 1e-15);
  EXPECT_NEAR(corrected[3], 0.02, 1e-15);
}

TEST(Holm, OneTestStaysAndNoneExceedsOne) {
  EXPECT_EQ(holm(std::vector<double>{0.03}), std::vector<double>{0.03});
  EXPECT_EQ(holm(std::vector<double>{0.9, 0.8}), (std::vector<double>{1, 1}));
  EXPECT_TRUE(holm({}).empty());
  EXPECT_THROW(holm(std::vector<double>{1.1}), Error);
}

}  // namespace
}  // namespace clipgs
