#include "volume/slice_flood.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace clipgs {
namespace {

/// Voxel by voxel, until nothing changes.
std::vector<std::uint8_t> by_definition(const IVec3& dims, const std::vector<std::uint8_t>& mask) {
  std::vector<std::uint8_t> reached(mask.size());
  for (bool more = true; more;) {
    more = false;
    for (int i = 0; i < static_cast<int>(mask.size()); ++i) {
      const IVec3 at(i % dims.x, i / dims.x % dims.y, i / dims.x / dims.y);
      const auto index = static_cast<size_t>(i);
      if (mask[index] != 0 || reached[index] != 0) {
        continue;
      }
      const auto width = static_cast<size_t>(dims.x);
      const bool edge = at.x == 0 || at.y == 0 || at.x == dims.x - 1 || at.y == dims.y - 1;
      if (edge || reached[index - 1] != 0 || reached[index + 1] != 0 ||
          reached[index - width] != 0 || reached[index + width] != 0) {
        reached[index] = 1;
        more = true;
      }
    }
  }
  return reached;
}

TEST(SliceFlood, ReachesWhatStepsReach) {
  // Rows shorter than a word, as long as one, and longer; slices of one row and of one column.
  for (const IVec3& dims : {IVec3(40, 30, 2), IVec3(64, 25, 2), IVec3(150, 40, 2), IVec3(129, 1, 3),
                            IVec3(1, 60, 2), IVec3(2, 2, 2)}) {
    for (const std::uint32_t one_in : {2U, 3U, 20U}) {  // at 3 paths wind
      Rng rng(one_in);
      std::vector<std::uint8_t> mask(static_cast<size_t>(dims.x) * dims.y * dims.z);
      BitMask bits(mask.size());
      for (size_t i = 0; i < mask.size(); ++i) {
        mask[i] = rng.below(one_in) == 0 ? 1 : 0;
        if (mask[i] != 0) {
          bits.set(i);
        }
      }
      const std::vector<std::uint8_t> expected = by_definition(dims, mask);
      EXPECT_EQ(flood_slices(dims, mask), expected) << dims.x << ", one in " << one_in;
      const BitMask got = flood_slices(dims, bits);
      for (size_t i = 0; i < mask.size(); ++i) {
        ASSERT_EQ(got[i], expected[i] != 0) << dims.x << ", " << i;
      }
    }
  }
}

TEST(SliceFlood, FollowsASpiral) {
  // A wall of one voxel that winds to the middle of 99 × 99.
  constexpr int kSide = 99;
  std::vector<std::uint8_t> mask(kSide * kSide, 1);
  glm::ivec2 at(0, 1);
  glm::ivec2 step(1, 0);
  mask[kSide] = 0;
  const auto is_wall = [&](const glm::ivec2& p) {
    return p.x >= 0 && p.y >= 0 && p.x < kSide && p.y < kSide &&
           mask[static_cast<size_t>(p.y * kSide + p.x)] != 0;
  };
  size_t length = 1;
  for (int turns = 0; turns < 2;) {
    if (is_wall(at + step) && is_wall(at + 2 * step)) {
      at += step;
      mask[static_cast<size_t>(at.y * kSide + at.x)] = 0;
      ++length;
      turns = 0;
    } else {
      step = {-step.y, step.x};
      ++turns;
    }
  }
  ASSERT_GT(length, 1000u);
  const std::vector<std::uint8_t> reached = flood_slices({kSide, kSide, 1}, mask);
  EXPECT_EQ(static_cast<size_t>(std::ranges::count(reached, 1)), length);
}

}  // namespace
}  // namespace clipgs
