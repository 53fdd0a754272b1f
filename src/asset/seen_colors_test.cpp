#include "asset/seen_colors.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "asset/draw_case.h"
#include "asset/test_case.h"
#include "splat/render.h"

namespace clipgs {
namespace {

/// The same discs, all of them blue.
Gaussians blue(Gaussians discs) {
  for (int c = 0; c < 3; ++c) {
    std::fill_n(discs.plane(Gaussians::kSh + c), discs.size(), c == 2 ? 1.5f : -1.5f);
  }
  return discs;
}

double difference(const Image& a, const Image& truth) {
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < truth.pixels(); ++i) {
    for (size_t c = 0; truth.data[4 * i + 3] > 0.99f && c < 3; ++c) {
      sum += std::abs(a.data[4 * i + c] - truth.data[4 * i + c]);
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

TEST(SeenColors, AreThoseOfTheCaseFromAnyPlace) {
  const Case contents = test::ball_case();
  const KeptSurfaces kept = kept_surfaces(*contents.section, scan_surfaces(*contents.section, true),
                                          *contents.openings, Cut(), 8000);
  for (const int degree : {0, 1}) {
    const Gaussians colored = in_seen_colors(contents, Cut(), blue(kept.discs), 0, degree);
    EXPECT_EQ(colored.sh_degree(), degree);
    EXPECT_GT(colored.size(), kept.discs.size() * 9 / 10);
    for (const View& view : {View{10, 20, 1}, View{140, -50, 1}}) {
      const Camera camera = frame_sphere(contents.scene.sphere, view, 96, 96);
      const Image truth = draw_case(contents, camera, Cut());
      const Image picture = render(colored, camera, std::nullopt, ClipOperator::kExact);
      EXPECT_LT(difference(picture, truth), 0.02) << degree;
    }
  }
}

TEST(SeenColors, OfWhatNoPictureShowsAreLeftOutOrKept) {
  const Case contents = test::ball_case();
  // Half of them within the ball, whose radius is 15 mm: hidden by its surface.
  Gaussians discs = blue(contents.scene.gaussians);
  const size_t inner = discs.size() / 2;
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < inner; ++i) {
      discs.plane(Gaussians::kMean + axis)[i] *= 0.5f;
    }
  }
  const auto count_within = [&](const Gaussians& all) {
    size_t within = 0;
    for (size_t i = 0; i < all.size(); ++i) {
      within += glm::length(all.mean(i)) < 9 ? 1 : 0;
    }
    return within;
  };
  // All of the surface again, in front of them.
  Gaussians both(discs.size() + contents.scene.gaussians.size(), 0);
  for (int p = 0; p < both.planes(); ++p) {
    std::copy_n(discs.plane(p), discs.size(), both.plane(p));
    std::copy_n(contents.scene.gaussians.plane(p), contents.scene.gaussians.size(),
                both.plane(p) + discs.size());
  }
  EXPECT_EQ(count_within(in_seen_colors(contents, Cut(), both, 0, 0)), 0U);
  const Gaussians kept = in_seen_colors(contents, Cut(), both, inner, 0);
  ASSERT_EQ(count_within(kept), inner);
  EXPECT_EQ(kept.plane(Gaussians::kSh + 2)[0], 1.5f);
}

TEST(SeenColors, OfNoDiscsAreNone) {
  EXPECT_EQ(in_seen_colors(test::ball_case(), Cut(), Gaussians(0, 0), 0, 1).size(), 0U);
}

}  // namespace
}  // namespace clipgs
