#include "volume/distance.h"

#include <algorithm>
#include <cstddef>
#include <gtest/gtest.h>

#include "core/random.h"
#include "volume/components.h"

namespace clipgs {
namespace {

TEST(Distance, IsThatOfTheNearestVoxel) {
  const IVec3 dims(13, 9, 11);
  const Vec3 spacing(1, 2.5f, 1.5f);
  constexpr float kMost = 6;
  BitMask mask(static_cast<size_t>(dims.x) * dims.y * dims.z);
  Rng rng(3);
  for (int i = 0; i < 12; ++i) {
    mask.set(rng.below(static_cast<std::uint32_t>(mask.size())));
  }
  const std::vector<float> found = distances_to(dims, spacing, mask, kMost);
  for (size_t i = 0; i < mask.size(); ++i) {
    float nearest = kMost;
    for (size_t j = mask.next(0); j < mask.size(); j = mask.next(j + 1)) {
      const Vec3 apart = Vec3(place_of(dims, i) - place_of(dims, j)) * spacing;
      nearest = std::min(nearest, glm::length(apart));
    }
    ASSERT_NEAR(found[i], nearest, 1e-4f) << i;
  }
}

TEST(Distance, OfNothingIsTheMost) {
  for (const float one : distances_to({3, 4, 5}, Vec3(1), BitMask(60), 7)) {
    EXPECT_EQ(one, 7);
  }
}

}  // namespace
}  // namespace clipgs
