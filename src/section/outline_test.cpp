#include "section/outline.h"

#include <gtest/gtest.h>

#include "section/section_light.h"
#include "section/test_section.h"

namespace clipgs {
namespace {

constexpr float kBallRadius = 15;  // mm, of test::ball_section()
constexpr int kPixels = 96;

Camera camera_from(const Vec3& from) {
  return frame_sphere({Vec3(0), kBallRadius}, glm::normalize(from), 1, kPixels, kPixels);
}

struct Ball {
  Section section = test::ball_section();
  EmptySpace empty_space = find_empty_space(section);
};

/// Rms difference from outline_reference() over the pixels' middles.
double difference(const Ball& s, const Camera& camera, const Cut& cut) {
  const Outline outline(s.section, s.empty_space, camera, cut);
  double squares = 0;
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const double expected = outline_reference(s.section, camera, cut, x + 0.5, y + 0.5);
      const float got = outline.along(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      squares += (got - expected) * (got - expected);
    }
  }
  return std::sqrt(squares / (kPixels * kPixels));
}

TEST(Outline, IsWhatManySmallStepsSay) {
  const Ball s;
  const Cut cut({Plane{glm::normalize(Vec3(0.3f, -0.2f, 1)), 2}, Plane{Vec3(1, 0, 0), -6}});
  for (const Vec3 from : {Vec3(0.3f, 0.2f, -1), Vec3(1, 0, 0), Vec3(-1, 2, 1)}) {
    EXPECT_LT(difference(s, camera_from(from), Cut()), 0.01);
    EXPECT_LT(difference(s, camera_from(from), cut), 0.01);
  }
}

TEST(Outline, CoversWhatTheBodyDoes) {
  const Ball s;
  const Camera view = camera_from(Vec3(0.3f, -1, 0.4f));
  const Outline outline(s.section, s.empty_space, view, Cut());
  double covered = 0;
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      covered += outline.of_pixel(x, y);
    }
  }
  // A ball's disk as the pinhole sees it: sin of half the angle is its radius over the distance.
  const float sine = kBallRadius / glm::length(view.position);
  const float radius = view.fx * sine / std::sqrt(1 - sine * sine);
  const double disk = 3.14159265 * radius * radius;
  EXPECT_NEAR(std::sqrt(covered / disk), 1, 0.02);
}

TEST(Outline, EndsAtThePlanes) {
  const Ball s;
  const Camera view = camera_from(Vec3(0, -1, 0));
  const Vec2 middle(0.5f * kPixels, 0.5f * kPixels);
  const auto along = [&](const Plane& plane) {
    return Outline(s.section, s.empty_space, view, plane).along(middle.x, middle.y);
  };
  EXPECT_GT(along({Vec3(0, 0, 1), -3}), 0.99f);
  EXPECT_EQ(along({Vec3(0, 0, 1), 3}), 0);  // the middle is above nothing that is left
  EXPECT_EQ(along({Vec3(0, 1, 0), 20}), 0);
  EXPECT_GT(along({Vec3(0, 1, 0), 10}), 0.99f);
}

TEST(Outline, ReplacesWhatSplatsCoverInPart) {
  const Ball s;
  const Camera view = camera_from(Vec3(0.2f, -1, 0.1f));
  const Outline outline(s.section, s.empty_space, view, Cut());
  Image picture(kPixels, kPixels, 4);
  for (size_t i = 0; i < picture.pixels(); ++i) {
    const float alpha = i % 3 == 0 ? 0.0f : (i % 3 == 1 ? 0.5f : 1.0f);
    const Vec4 color(0.2f, 0.4f, 0.6f, alpha);
    std::copy_n(&color[0], 4, &picture.data[4 * i]);
  }
  const Image before = picture;
  draw_outline(picture, nullptr, outline);
  for (int y = 0; y < kPixels; ++y) {
    for (int x = 0; x < kPixels; ++x) {
      const float was = before.at(x, y)[3];
      EXPECT_EQ(picture.at(x, y)[3], was == 0.5f ? outline.of_pixel(x, y) : was);
      if (picture.at(x, y)[3] > 0) {
        EXPECT_NEAR(picture.at(x, y)[1], 0.4f, 1e-5f);
      }
    }
  }
}

TEST(Outline, LeavesFacesAsTheyAre) {
  const Ball s;
  const Camera view = camera_from(Vec3(0.2f, -1, 0.1f));
  const Outline outline(s.section, s.empty_space, view, Cut());
  Image faces(kPixels, kPixels, 4);
  Image picture(kPixels, kPixels, 4);
  const int middle = kPixels / 2;
  // Of a pixel of matter a face has a quarter, red, and splats as much again, blue.
  const Vec4 face(0.25f, 0, 0, 0.25f);
  const Vec4 both(0.5f, 0, 0.5f, 0.5f);
  std::copy_n(&face[0], 4, faces.at(middle, middle));
  std::copy_n(&both[0], 4, picture.at(middle, middle));
  draw_outline(picture, &faces, outline);
  const float* const pixel = picture.at(middle, middle);
  EXPECT_NEAR(pixel[3], 1, 1e-5f);
  EXPECT_NEAR(pixel[0], 0.25f, 1e-5f);
  EXPECT_NEAR(pixel[2], 0.75f, 1e-5f);
}

}  // namespace
}  // namespace clipgs
