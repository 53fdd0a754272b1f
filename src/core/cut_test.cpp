#include "core/cut.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

TEST(Cut, OppositePlanesFollowEachOther) {
  const Plane a{Vec3(0, 0, 1), 1};
  const Plane b{Vec3(1, 0, 0), 2};
  const Plane opposite{Vec3(0, 0, -1), -5};
  const Cut cut(std::vector{a, b, opposite});
  ASSERT_EQ(cut.planes().size(), 3U);
  EXPECT_EQ(cut.planes()[1].offset, -5);
  EXPECT_EQ(cut.planes()[2].offset, 2);
  EXPECT_TRUE(Cut(std::nullopt).empty());
  EXPECT_EQ(Cut(std::optional(a)).planes().size(), 1U);
  EXPECT_THROW(Cut(std::vector<Plane>(7)), Error);
}

}  // namespace
}  // namespace clipgs
