#include "volume/steepness_histogram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

using testing::HasSubstr;

/// 100 below x = 8, 300 above, in voxels of 2 mm, with a ramp between that is 50 per mm steep.
Volume step_volume() {
  Volume volume;
  volume.dims = {16, 9, 20};
  volume.spacing = Vec3(2);
  std::vector<float> values;
  for (size_t i = 0; i < volume.voxels(); ++i) {
    values.push_back(i % 16 < 8 ? 100.0f : 300.0f);
  }
  volume.values = VoxelValues(std::move(values));
  return volume;
}

std::uint64_t counted(const SteepnessHistogram& histogram) {
  std::uint64_t sum = 0;
  for (const auto& row : *histogram.counts) {
    for (const std::uint64_t count : row) {
      sum += count;
    }
  }
  return sum;
}

TEST(SteepnessHistogram, TellsEvenMatterFromItsBorders) {
  const Volume volume = step_volume();
  const SteepnessHistogram histogram = steepness_histogram(volume, -1000, 1000, "here");
  EXPECT_EQ(histogram.low, 100);
  EXPECT_EQ(histogram.high, 300);
  EXPECT_GE(histogram.steepest, 50);
  EXPECT_LT(histogram.steepest, 52);
  EXPECT_GT(counted(histogram), 0.99 * volume.voxels());
  // Voxels at the ends and their neighbours are even, but for those beside the ramp.
  const std::uint64_t side = 9 * 20;
  EXPECT_NEAR((*histogram.counts)[0].front(), 6.5 * side, 0.2 * side);
  EXPECT_NEAR((*histogram.counts)[0].back(), 6.5 * side, 0.2 * side);
  // On the ramp itself it is nowhere less steep than half of what it is at its ends.
  const auto middle = static_cast<size_t>(SteepnessHistogram::kColumns / 2);
  for (size_t row = 0; row < SteepnessHistogram::kRows * 4 / 10; ++row) {
    EXPECT_EQ((*histogram.counts)[row][middle], 0) << row;
  }
}

TEST(SteepnessHistogram, CountsTheValuesThatAreAskedFor) {
  const SteepnessHistogram histogram = steepness_histogram(step_volume(), 200, 400, "here");
  EXPECT_EQ(histogram.low, 200);
  EXPECT_EQ(histogram.high, 300);
  EXPECT_NEAR(counted(histogram), 8 * 9 * 20, 0.05 * 8 * 9 * 20);
}

TEST(SteepnessHistogram, IsTheSameAtAnyThreadCount) {
  const Volume volume = step_volume();
  set_thread_count(1);
  const SteepnessHistogram one = steepness_histogram(volume, 0, 400, "here");
  set_thread_count(0);
  EXPECT_EQ(*one.counts, *steepness_histogram(volume, 0, 400, "here").counts);
}

TEST(SteepnessHistogram, WhereThereIsNoneIsAnError) {
  const auto error = [](const Volume& volume, float low, float high) -> std::string {
    try {
      steepness_histogram(volume, low, high, "here");
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  };
  Volume constant = step_volume();
  constant.values = VoxelValues(std::vector<float>(constant.voxels(), 7.0f));
  EXPECT_THAT(error(constant, 0, 100), HasSubstr("here: every voxel has the value 7"));
  EXPECT_THAT(error(step_volume(), 400, 500), HasSubstr("here: between the values 400 and 500"));
}

}  // namespace
}  // namespace clipgs
