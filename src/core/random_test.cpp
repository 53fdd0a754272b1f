#include "core/random.h"

#include <atomic>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/parallel.h"

namespace clipgs {
namespace {

TEST(Rng, SameSeedSameSequenceOtherStreamOther) {
  Rng a(7, 3);
  Rng b(7, 3);
  Rng c(7, 4);
  int equal = 0;
  for (int i = 0; i < 100; ++i) {
    const auto value = a.next();
    EXPECT_EQ(value, b.next());
    equal += value == c.next() ? 1 : 0;
  }
  EXPECT_LT(equal, 3);
}

TEST(Rng, MomentsAreRight) {
  Rng rng(1);
  const int n = 100000;
  double mean = 0;
  double square = 0;
  double uniform = 0;
  for (int i = 0; i < n; ++i) {
    const double x = rng.normal();
    mean += x / n;
    square += x * x / n;
    uniform += rng.uniform() / n;
  }
  EXPECT_NEAR(mean, 0, 0.02);
  EXPECT_NEAR(square, 1, 0.03);
  EXPECT_NEAR(uniform, 0.5, 0.01);
}

TEST(Parallel, CoversTheRangeOnce) {
  std::vector<std::atomic<int>> hits(1001);
  parallel_for(hits.size(), 7, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      hits[i]++;
    }
  });
  for (const auto& h : hits) {
    EXPECT_EQ(h, 1);
  }
}

}  // namespace
}  // namespace clipgs
