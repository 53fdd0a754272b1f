#include "volume/transfer_function.h"

#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "core/random.h"

namespace clipgs {
namespace {

TransferPoint point(float value, float extinction, float red = 0.5f) {
  TransferPoint p;
  p.value = value;
  p.material.extinction = extinction;
  p.material.albedo = Vec3(red, 0.5f, 0.5f);
  return p;
}

TEST(TransferFunction, InterpolatesAndIsConstantBeyondTheEnds) {
  const TransferFunction tf({point(100, 2, 1), point(0, 0, 0)});  // any order
  EXPECT_NEAR(tf.at(25).extinction, 0.5f, 1e-3f);
  EXPECT_NEAR(tf.at(25).albedo.r, 0.25f, 1e-3f);
  EXPECT_EQ(tf.at(-1e6f).extinction, 0);
  EXPECT_EQ(tf.at(1e6f).extinction, 2);
}

TEST(TransferFunction, OnePointIsConstant) {
  const TransferFunction tf({point(7, 3)});
  EXPECT_EQ(tf.at(-100).extinction, 3);
  EXPECT_EQ(tf.max_extinction(-100, 100), 3);
}

TEST(TransferFunction, EqualValuesMakeAStep) {
  const TransferFunction tf({point(0, 0), point(50, 0), point(50, 4), point(100, 4)});
  EXPECT_EQ(tf.at(49).extinction, 0);
  EXPECT_EQ(tf.at(51).extinction, 4);
}

// The majorant of a cell relies on it: never below any value that at() returns in the range.
TEST(TransferFunction, RangeQueriesBoundEveryValueOfANonMonotonicFunction) {
  std::vector<TransferPoint> points;
  Rng rng(5);
  for (int i = 0; i < 40; ++i) {
    points.push_back(point(2000 * rng.uniform() - 1000, 3 * rng.uniform()));
  }
  const TransferFunction tf(points);
  for (int trial = 0; trial < 300; ++trial) {
    float low = 2400 * rng.uniform() - 1200;
    float high = low + 500 * rng.uniform() * rng.uniform();
    const float max = tf.max_extinction(low, high);
    const float min = tf.min_extinction(low, high);
    float seen_max = 0;
    float seen_min = 1e9f;
    for (int i = 0; i <= 2000; ++i) {
      const float e = tf.at(low + (high - low) * static_cast<float>(i) / 2000).extinction;
      seen_max = std::max(seen_max, e);
      seen_min = std::min(seen_min, e);
    }
    EXPECT_GE(max, seen_max);
    EXPECT_LE(min, seen_min);
    EXPECT_NEAR(max, seen_max, 0.05f);  // and tight
    EXPECT_NEAR(min, seen_min, 0.05f);
  }
}

TEST(TransferFunction, RefusesWhatIsNoMaterial) {
  EXPECT_THROW(TransferFunction(std::vector<TransferPoint>()), Error);
  EXPECT_THROW(TransferFunction({point(0, -1)}), Error);
  EXPECT_THROW(TransferFunction({point(0, std::numeric_limits<float>::infinity())}), Error);
  EXPECT_THROW(TransferFunction({point(std::numeric_limits<float>::quiet_NaN(), 1)}), Error);
  EXPECT_THROW(TransferFunction({point(0, 1, 1.5f)}), Error);
}

}  // namespace
}  // namespace clipgs
