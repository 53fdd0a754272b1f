#include "volume/metal.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/parallel.h"
#include "core/random.h"

namespace clipgs {
namespace {

/// Soft tissue with noise, two bones (one of them near), metal in the upper half of the slices, and
/// a fan of bright and dark wedges of 3 degrees around it that fades with the distance.
Volume scan(bool streaks) {
  Volume volume;
  volume.dims = {160, 140, 6};
  volume.spacing = {1, 1, 2};
  volume.modality = Modality::kCt;
  Rng rng(9);
  std::vector<float> values;
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        const Vec2 p(static_cast<float>(x) - 60, static_cast<float>(y) - 70);
        const float distance = glm::length(p);
        const bool bone = glm::length(p - Vec2(85, 0)) < 8 || glm::length(p - Vec2(0, 35)) < 8;
        float value = (bone ? 900.0f : 40.0f) + 8 * rng.normal();
        if (z >= 3 && streaks && distance >= 5) {
          const int wedge = static_cast<int>(std::floor(std::atan2(p.y, p.x) / kPi * 60));
          value += (wedge % 2 == 0 ? 220.0f : -220.0f) * std::exp(-distance / 25);
        }
        if (z >= 3 && distance < 5) {
          value = 3071;
        }
        values.push_back(std::round(value));
      }
    }
  }
  volume.values = std::move(values);
  return volume;
}

/// Rms of the differences of slice `z` where `where(distance from the metal)`.
template <typename Where>
double rms(const Volume& a, const Volume& b, int z, const Where& where) {
  double squares = 0;
  double count = 0;
  for (int y = 0; y < a.dims.y; ++y) {
    for (int x = 0; x < a.dims.x; ++x) {
      if (where(std::hypot(static_cast<float>(x) - 60, static_cast<float>(y) - 70))) {
        const double difference = a.at(x, y, z) - b.at(x, y, z);
        squares += difference * difference;
        count += 1;
      }
    }
  }
  return std::sqrt(squares / count);
}

TEST(SoftenMetal, StreaksFallByMoreThanAThirdAndWhatIsAwayStays) {
  const Volume clean = scan(false);
  const Volume before = scan(true);
  Volume volume = before;
  const MetalSoftening done = soften_metal(volume, kMetal);
  EXPECT_EQ(done.slices, 3);
  EXPECT_NEAR(done.metal_ml, 3 * kPi * 25 * 2 / 1000, 0.07);
  const auto near = [](float distance) { return distance >= 5 && distance < 60; };
  EXPECT_LT(rms(volume, clean, 4, near), 0.667 * rms(before, clean, 4, near));
  // Slices without metal, the metal itself, and what is far from it; a bone there as well.
  EXPECT_EQ(rms(volume, before, 1, [](float) { return true; }), 0);
  EXPECT_EQ(rms(volume, before, 4, [](float distance) { return distance < 5; }), 0);
  EXPECT_EQ(rms(volume, before, 4, [](float distance) { return distance > 72; }), 0);
  // The near bone keeps its edge: as dense as it was within, and as soft around it.
  EXPECT_NEAR(volume.at(60, 105, 4), 900, 80);
  EXPECT_NEAR(volume.at(60, 95, 4), 40, 80);
}

TEST(SoftenMetal, NothingHappensWithoutMetal) {
  Volume volume = scan(true);
  volume.values.transform([](float value) { return std::min(value, 2000.0f); });
  const VoxelValues before = volume.values;
  EXPECT_EQ(soften_metal(volume, kMetal).slices, 0);
  EXPECT_EQ(volume.values, before);
}

TEST(SoftenMetal, DoesNotDependOnThreads) {
  Volume one = scan(true);
  Volume many = one;
  set_thread_count(1);
  soften_metal(one, kMetal);
  set_thread_count(0);
  soften_metal(many, kMetal);
  EXPECT_EQ(one.values, many.values);
}

}  // namespace
}  // namespace clipgs
