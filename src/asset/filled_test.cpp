#include "asset/filled.h"

#include <cmath>
#include <gtest/gtest.h>

#include "asset/draw_case.h"
#include "core/error.h"
#include "section/surface_splats.h"
#include "section/test_section.h"

namespace clipgs {
namespace {

/// A ball of which nothing is learnt: its surface is discs.
Case ball_case() {
  Case contents(Scene{}, test::ball_section());
  const SurfaceScan scan = scan_surfaces(*contents.section);
  contents.openings = std::make_shared<const Openings>(*contents.section, scan);
  contents.scene.gaussians = surface_splats(*contents.section, scan, *contents.openings, 8000);
  contents.scene.sphere = {{0, 0, 0}, 16};
  contents.scene.placed = true;
  return contents;
}

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
  const Case contents = ball_case();
  const Cut cut(Plane{glm::normalize(Vec3(0.3f, 1, -0.4f)), -1});
  const Camera camera = frame_sphere(contents.scene.sphere, View{200, 30, 1}, 128, 128);
  const Image truth = draw_case(contents, camera, cut);
  const Case filled = of_splats(filled_splats(contents, cut, 30000));
  const Case hollow = of_splats(contents.scene.gaussians);
  const double with = likeness(draw_case(filled, camera, Cut()), truth);
  EXPECT_GT(with, 28);
  EXPECT_GT(with, likeness(draw_case(hollow, camera, cut), truth) + 5);
}

TEST(FilledSplats, OfAModelAreRefused) {
  Case contents(Scene{});
  contents.model.emplace();
  EXPECT_THROW(filled_splats(contents, Cut(), 100), Error);
}

}  // namespace
}  // namespace clipgs
