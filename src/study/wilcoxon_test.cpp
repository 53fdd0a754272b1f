#include "study/wilcoxon.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/random.h"

namespace clipgs {
namespace {

const std::vector<double> kRankedDifferences = {2, 1, 3, 1, -1, 2, 4, 0, 1, 3, 2, -2};

/// Whole differences within ±most, so that there are ties and zeros.
std::vector<double> random_differences(std::uint64_t seed, size_t n, int most) {
  Rng rng(seed);
  std::vector<double> result(n);
  for (double& d : result) {
    d = static_cast<int>(rng.below(static_cast<std::uint32_t>(2 * most + 1))) - most;
  }
  return result;
}

/// The exact p by trying all signs.
double enumerated_p(std::vector<double> differences) {
  std::erase(differences, 0.0);
  const size_t n = differences.size();
  std::vector<double> ranks(n);
  for (size_t i = 0; i < n; ++i) {
    double below = 0;
    double equal = 0;
    for (const double other : differences) {
      below += std::abs(other) < std::abs(differences[i]) ? 1 : 0;
      equal += std::abs(other) == std::abs(differences[i]) ? 1 : 0;
    }
    ranks[i] = below + (equal + 1) / 2;
  }
  double plus = 0;
  double minus = 0;
  for (size_t i = 0; i < n; ++i) {
    (differences[i] > 0 ? plus : minus) += ranks[i];
  }
  const double least = std::min(plus, minus);
  double extreme = 0;
  for (size_t signs = 0; signs < size_t{1} << n; ++signs) {
    double sum = 0;
    for (size_t i = 0; i < n; ++i) {
      sum += (signs >> i & 1) != 0 ? ranks[i] : 0;
    }
    extreme += sum <= least ? 1 : 0;
  }
  return std::min(1.0, 2 * extreme / std::ldexp(1.0, static_cast<int>(n)));
}

// References: scipy.stats.wilcoxon(correction=False, mode="approx"); all signs tried, for the exact
// p.
TEST(Wilcoxon, IsThatOfScipy) {
  const Wilcoxon test = wilcoxon_signed_rank(kRankedDifferences).value();
  EXPECT_EQ(test.w, 9);
  EXPECT_NEAR(test.z, -2.1564, 5e-5);
  EXPECT_NEAR(test.p, 0.03105628579161289, 1e-12);
  EXPECT_EQ(test.exact_p, 0.0341796875);
  EXPECT_EQ(test.plus, 57);
  EXPECT_EQ(test.minus, 9);
  EXPECT_NEAR(test.r, 48.0 / 66, 1e-15);
}

TEST(Wilcoxon, DropsZeros) {
  const Wilcoxon test = wilcoxon_signed_rank(kRankedDifferences).value();
  EXPECT_EQ(test.n, 11);
  EXPECT_EQ(test.zeros, 1);
  std::vector<double> without = kRankedDifferences;
  std::erase(without, 0.0);
  const Wilcoxon same = wilcoxon_signed_rank(without).value();
  EXPECT_EQ(same.w, test.w);
  EXPECT_EQ(same.p, test.p);
  EXPECT_EQ(same.exact_p, test.exact_p);
}

TEST(Wilcoxon, NothingIsTestedWhereAllDifferencesAreZero) {
  EXPECT_FALSE(wilcoxon_signed_rank(std::vector<double>{0, 0, -0.0}));
}

TEST(Wilcoxon, RefusesNoDifferencesAndInfinity) {
  EXPECT_THROW(wilcoxon_signed_rank({}), Error);
  EXPECT_THROW(wilcoxon_signed_rank(std::vector<double>{1, std::nan("")}), Error);
}

TEST(Wilcoxon, TheExactPIsThatOfAllSigns) {
  size_t tied = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const std::vector<double> differences =
        random_differences(seed, 1 + seed % 12, seed % 3 == 0 ? 1000000 : 4);
    const std::optional<Wilcoxon> test = wilcoxon_signed_rank(differences);
    if (test) {
      EXPECT_DOUBLE_EQ(test->exact_p.value(), enumerated_p(differences)) << seed;
      tied += seed % 3 != 0 && test->n > 5 ? 1 : 0;
    }
  }
  EXPECT_GT(tied, 10) << "hardly any had ties";
}

TEST(Wilcoxon, OneSidedDifferencesHaveTheLeastExactP) {
  for (const size_t n : {1U, 5U, 9U, 25U}) {
    const std::vector<double> differences(n, 1.0);
    const Wilcoxon test = wilcoxon_signed_rank(differences).value();
    EXPECT_EQ(test.exact_p.value(), std::ldexp(2.0, -static_cast<int>(n))) << n;
    EXPECT_EQ(test.w, 0);
    EXPECT_EQ(test.r, 1);
  }
  EXPECT_FALSE(wilcoxon_signed_rank(std::vector<double>(26, 1.0)).value().exact_p);
}

TEST(Wilcoxon, TheOrderOfRowsDoesNotMatter) {
  std::vector<double> differences = kRankedDifferences;
  const Wilcoxon before = wilcoxon_signed_rank(differences).value();
  for (int i = 0; i < 20; ++i) {
    std::ranges::next_permutation(differences);
    std::ranges::rotate(differences, differences.begin() + i % 12);
    const Wilcoxon after = wilcoxon_signed_rank(differences).value();
    EXPECT_EQ(after.w, before.w);
    EXPECT_EQ(after.z, before.z);
    EXPECT_EQ(after.exact_p, before.exact_p);
    EXPECT_EQ(after.r, before.r);
  }
}

TEST(Wilcoxon, SwappedModesFlipTheSignAlone) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<double> differences = random_differences(seed, 15, 6);
    const Wilcoxon before = wilcoxon_signed_rank(differences).value();
    for (double& d : differences) {
      d = -d;
    }
    const Wilcoxon after = wilcoxon_signed_rank(differences).value();
    EXPECT_EQ(after.plus, before.minus);
    EXPECT_EQ(after.r, -before.r);
    EXPECT_EQ(after.w, before.w);
    EXPECT_EQ(after.z, before.z);
    EXPECT_EQ(after.p, before.p);
    EXPECT_EQ(after.exact_p, before.exact_p);
  }
}

TEST(Wilcoxon, OnlyRanksOfSizesMatter) {
  std::vector<double> cubes = kRankedDifferences;
  for (double& d : cubes) {
    d = d * d * d / 7;
  }
  EXPECT_EQ(wilcoxon_signed_rank(cubes).value().p,
            wilcoxon_signed_rank(kRankedDifferences).value().p);
}

// At 25 pairs without ties the two lie at most 0.0153 apart, whatever W (counted for all of them).
TEST(Wilcoxon, ExactAndNormalPAgreeForManyPairs) {
  size_t small = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Rng rng(seed);
    std::vector<double> differences(kMostExactPairs);
    for (double& d : differences) {
      d = rng.normal() + static_cast<double>(seed % 5) * 0.2;
    }
    const Wilcoxon test = wilcoxon_signed_rank(differences).value();
    EXPECT_NEAR(test.exact_p.value(), test.p, 0.0153) << seed;
    small += test.p < 0.05 ? 1 : 0;
  }
  EXPECT_GT(small, 10);
  EXPECT_LT(small, 45);
}

TEST(Wilcoxon, ADifferenceThatTurnsRoundMakesItLessSure) {
  std::vector<double> differences(12);
  for (size_t i = 0; i < differences.size(); ++i) {
    differences[i] = static_cast<double>(i + 1);
  }
  double p = wilcoxon_signed_rank(differences).value().exact_p.value();
  for (size_t i = 0; i < 5; ++i) {
    differences[i] = -differences[i];
    const Wilcoxon next = wilcoxon_signed_rank(differences).value();
    EXPECT_GT(next.exact_p.value(), p) << i;
    p = next.exact_p.value();
  }
}

}  // namespace
}  // namespace clipgs
