#include "volume/smooth_within.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace clipgs {
namespace {

Volume spike(float value) {
  Volume volume;
  volume.dims = {41, 41, 21};
  volume.spacing = {0.5f, 0.5f, 1};
  std::vector<float> values(volume.voxels(), 0.0f);
  values[volume.offset(20, 20, 10)] = value;
  volume.values = std::move(values);
  return volume;
}

BitMask all(const Volume& volume) {
  BitMask mask(volume.voxels());
  mask.fill(0, mask.size(), [](size_t) { return true; });
  return mask;
}

TEST(SmoothWithin, SpreadsASpikeAsAGaussianDoes) {
  Volume volume = spike(4096);
  smooth_within(volume, all(volume), 1.2f);
  double sum = 0;
  Vec3 variance(0);
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const Vec3 mm = Vec3(x - 20, y - 20, z - 10) * volume.spacing;
        sum += volume.at(x, y, z);
        variance += volume.at(x, y, z) * mm * mm;
      }
    }
  }
  EXPECT_NEAR(sum, 4096, 25);  // tails of less than half a step of 16 bits are lost
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(variance[k] / sum, 1.44, 0.05) << k;
  }
}

TEST(SmoothWithin, LeavesWhatIsNotOfTheMask) {
  Volume volume = spike(1000);
  Rng rng(2);
  std::vector<float> values;
  for (size_t i = 0; i < volume.voxels(); ++i) {
    values.push_back(static_cast<float>(rng.below(2000)));
  }
  volume.values = values;
  BitMask mask(volume.voxels());
  smooth_within(volume, mask, 1);
  EXPECT_TRUE(volume.values == VoxelValues(values));
  mask.set(volume.offset(0, 0, 0));  // a corner
  mask.set(volume.offset(7, 9, 3));
  smooth_within(volume, mask, 1);
  for (size_t i = 0; i < values.size(); ++i) {
    if (mask[i]) {
      EXPECT_NE(volume.values[i], values[i]);
    } else {
      ASSERT_EQ(volume.values[i], values[i]) << i;
    }
  }
}

}  // namespace
}  // namespace clipgs
