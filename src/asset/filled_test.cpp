#include "asset/filled.h"

#include <cmath>
#include <gtest/gtest.h>

#include "asset/draw_case.h"
#include "asset/test_case.h"
#include "core/error.h"
#include "core/random.h"

namespace clipgs {
namespace {

Case of_splats(Gaussians gaussians) {
  Scene scene;
  scene.gaussians = std::move(gaussians);
  return {std::move(scene)};
}

/// dB over the pixels that are all body.
double likeness(const Image& a, const Image& truth) {
  double squares = 0;
  size_t count = 0;
  for (size_t i = 0; i < a.pixels(); ++i) {
    for (size_t c = 0; truth.data[4 * i + 3] > 0.99f && c < 3; ++c) {
      squares += std::pow(a.data[4 * i + c] * a.data[4 * i + 3] - truth.data[4 * i + c], 2);
      ++count;
    }
  }
  return -10 * std::log10(squares / static_cast<double>(count));
}

TEST(FilledSplats, ShowACutBodyMuchAsTheCaseDoes) {
  const Case contents = test::ball_case();
  const Cut cut(Plane{glm::normalize(Vec3(0.3f, 1, -0.4f)), -1});
  const Camera camera = frame_sphere(contents.scene.sphere, View{200, 30, 1}, 128, 128);
  const Image truth = draw_case(contents, camera, cut);
  const Case filled = of_splats(filled_splats(contents, cut, 30000));
  const Case hollow = of_splats(contents.scene.gaussians);
  const double with = likeness(draw_case(filled, camera, Cut()), truth);
  EXPECT_GT(with, 28);
  EXPECT_GT(with, likeness(draw_case(hollow, camera, cut), truth) + 5);
}

TEST(FilledSplats, ShowSkinWithoutTheSpotsOfItsSplats) {
  const Camera camera = frame_sphere({{0, 0, 0}, 16}, View{30, -20, 1}, 128, 128);
  const Image truth = draw_case(test::ball_case(), camera, Cut());
  Case contents = test::ball_case();
  // As after training behind what the section draws: right in the mean, and some in the air.
  contents.scene.placed = false;
  Gaussians& splats = contents.scene.gaussians;
  Rng rng(1);
  for (size_t i = 0; i < splats.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      splats.plane(Gaussians::kSh + c)[i] += rng.uniform() - 0.5f;
      splats.plane(Gaussians::kMean + c)[i] *= i % 50 == 0 ? 1.1f : 1.0f;
    }
  }
  const Gaussians filled = filled_splats(contents, Cut(), 8000);
  for (size_t i = 0; i < filled.size(); ++i) {
    ASSERT_LT(glm::length(filled.mean(i)), 15.5);
  }
  EXPECT_GT(likeness(draw_case(of_splats(filled), camera, Cut()), truth),
            likeness(draw_case(of_splats(splats), camera, Cut()), truth) + 3);
}

TEST(FilledSplats, OfAModelAreRefused) {
  Case contents(Scene{});
  contents.model.emplace();
  EXPECT_THROW(filled_splats(contents, Cut(), 100), Error);
}

}  // namespace
}  // namespace clipgs
