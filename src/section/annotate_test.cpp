#include "section/annotate.h"

#include <gtest/gtest.h>

#include "section/test_section.h"

namespace clipgs {
namespace {

TEST(Annotate, LettersOfDirections) {
  EXPECT_EQ(direction_letters(Vec3(1, 0, 0)), "R");
  EXPECT_EQ(direction_letters(Vec3(-1, 0.1f, 0)), "L");
  EXPECT_EQ(direction_letters(glm::normalize(Vec3(0, -0.5f, 0.8f))), "SP");
  EXPECT_EQ(direction_letters(glm::normalize(Vec3(-1, 1, -1))), "LAI");
}

TEST(Annotate, ValuesWithTheirError) {
  Section section = test::ball_section();
  section.value_errors.fill(3.6f);
  EXPECT_EQ(value_text(section, Vec3(0)), "250 ± 4 HU");
  section.value_errors.fill(0.3f);
  EXPECT_EQ(value_text(section, Vec3(0, 0, 5)), "250 ± 0.3 HU");
  EXPECT_EQ(value_text(section, Vec3(0, 0, 17)), "outside");  // air around the body
  EXPECT_EQ(value_text(section, Vec3(0, 0, 300)), "outside");
  section.modality = Modality::kMr;
  EXPECT_EQ(value_text(section, Vec3(0)), "250 ± 0.3");
}

/// Longest run of white in the row.
int longest_run(const Image& picture, int y) {
  int longest = 0;
  int run = 0;
  for (int x = 0; x < picture.width; ++x) {
    run = picture.at(x, y)[0] == 1 ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

TEST(Annotate, TheBarIsAsLongAsItSays) {
  const Section section = test::ball_section();
  const Plane plane{Vec3(0, 0, 1), 5};
  const Camera camera = frame_sphere({Vec3(0), 15}, Vec3(0, 0, -1), 1, 400, 400);
  Image picture(400, 400, 4);
  annotate(picture, section, camera, plane, {}, {});
  const float pixels_per_mm = camera.fx / camera.to_camera(Vec3(0, 0, 5)).z;
  int bar = 0;
  for (int y = 350; y < 400; ++y) {
    bar = std::max(bar, longest_run(picture, y));
  }
  EXPECT_NEAR(static_cast<float>(bar), 5 * pixels_per_mm, 1);  // 10 mm are more than a quarter
}

TEST(Annotate, PinsAreMarkedWhereTheyAre) {
  const Section section = test::ball_section();
  const Camera camera = frame_sphere({Vec3(0), 15}, Vec3(0, 1, 0), 1, 200, 200);
  Image picture(200, 200, 4);
  const std::array pins = {Vec3(-4, 3, 2), Vec3(0, 1000, 0)};  // the second behind the camera
  annotate(picture, section, camera, {}, {}, pins);
  const Vec3 local = camera.to_camera(pins[0]);
  const float x = camera.fx * local.x / local.z + camera.cx;
  const float y = camera.fy * local.y / local.z + camera.cy;
  EXPECT_EQ(picture.at(static_cast<int>(x), static_cast<int>(y))[0], 1);
  EXPECT_EQ(picture.at(static_cast<int>(x), static_cast<int>(y) + 30)[3], 0);
}

}  // namespace
}  // namespace clipgs
