#include "volume/dilate.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace clipgs {
namespace {

struct Input {
  IVec3 dims;
  Vec3 spacing;
  BitMask mask;
};

Input random_input(const IVec3& dims, const Vec3& spacing, std::uint32_t one_in) {
  Input input{dims, spacing, BitMask(static_cast<size_t>(dims.x) * dims.y * dims.z)};
  Rng rng(one_in);
  for (size_t i = 0; i < input.mask.size(); ++i) {
    if (rng.below(one_in) == 0) {
      input.mask.set(i);
    }
  }
  return input;
}

IVec3 place(const IVec3& dims, size_t i) {
  const auto at = static_cast<int>(i);
  return {at % dims.x, at / dims.x % dims.y, at / dims.x / dims.y};
}

/// Every voxel against every other.
BitMask by_definition(const Input& input, float radius) {
  BitMask result(input.mask.size());
  for (size_t i = 0; i < result.size(); ++i) {
    for (size_t j = input.mask.next(0); j < result.size() && !result[i];
         j = input.mask.next(j + 1)) {
      const glm::dvec3 apart =
          glm::dvec3(place(input.dims, i) - place(input.dims, j)) * glm::dvec3(input.spacing);
      if (glm::dot(apart, apart) <= static_cast<double>(radius) * radius) {
        result.set(i);
      }
    }
  }
  return result;
}

void expect_same(const BitMask& a, const BitMask& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i], b[i]) << i;
  }
}

TEST(Dilate, IsWhatIsNear) {
  // Rows shorter than a word, as long as words and longer; voxels of any shape.
  for (const auto& [dims, spacing] : {std::pair(IVec3(7, 9, 11), Vec3(1, 0.7f, 1.3f)),
                                      std::pair(IVec3(64, 8, 5), Vec3(0.4f, 1, 3)),
                                      std::pair(IVec3(131, 6, 4), Vec3(0.3f, 0.9f, 2.1f))}) {
    const Input input = random_input(dims, spacing, 150);
    for (const float radius : {0.0f, 0.75f, 2.05f, 4.4f, 1000.0f}) {
      SCOPED_TRACE(testing::Message() << dims.x << " wide, " << radius << " mm");
      expect_same(dilated(dims, spacing, input.mask, radius), by_definition(input, radius));
    }
  }
}

TEST(Dilate, OfNothingIsNothing) {
  const IVec3 dims(70, 5, 5);
  const BitMask nothing(70 * 25);
  EXPECT_EQ(dilated(dims, Vec3(1), nothing, 10).count(), 0u);
}

TEST(Dilate, ErodingLeavesWhatIsFarFromTheRestAndAllAtTheBorders) {
  const Input input = random_input({33, 20, 9}, Vec3(1, 1.2f, 2), 40);
  const Input rest{input.dims, input.spacing, input.mask.inverted()};
  expect_same(eroded(rest.dims, rest.spacing, rest.mask, 2.3f),
              by_definition(input, 2.3f).inverted());
  BitMask all(input.mask.size());
  all = all.inverted();
  EXPECT_EQ(eroded(input.dims, input.spacing, all, 5).count(), all.size());
}

}  // namespace
}  // namespace clipgs
