#include "section/surface.h"

#include <gtest/gtest.h>

#include "section/faces.h"
#include "section/outline.h"
#include "section/test_section.h"

namespace clipgs {
namespace {

constexpr int kSide = 64;

Camera camera_at(const Vec3& from) {
  return frame_sphere({Vec3(0), 15}, glm::normalize(from), 1, kSide, kSide);
}

struct LitBall {
  Section section = test::ball_section();
  Openings openings{section};

  Image seen(const Camera& camera, const Cut& cut, const DepthCue& cue = {}) const {
    return draw_surface(section, camera, cut, OpenedLight(openings, cut), cue, 8);
  }
};

double sum_of_alpha(const Image& image) {
  double sum = 0;
  for (size_t i = 0; i < image.pixels(); ++i) {
    sum += image.data[4 * i + 3];
  }
  return sum;
}

TEST(Surface, CoversWhatTheBodyDoes) {
  const LitBall s;
  const Camera camera = camera_at({0.3f, -1, 0.4f});
  const Image image = s.seen(camera, Cut());
  const Outline outline(s.section, s.openings.empty_space(), camera, Cut());
  double body = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      body += outline.of_pixel(x, y);
    }
  }
  EXPECT_NEAR(sum_of_alpha(image) / body, 1, 0.03);
}

// A nose that all but touches the side of the volume: what is seen through that side of a cut body
// is its surface, not a gap of a face.
TEST(Surface, HasNoHolesWhereTheVolumeEndsBeforeMatterDoes) {
  LitBall s;
  s.section = make_section(make_ball(32, 14.9f, 250, -1000), load_preset("skin-and-bone"), {64});
  s.openings = Openings(s.section);
  ASSERT_TRUE(s.section.ends().empty());
  const Cut cut = Plane{Vec3(0, 0, 1), -10};  // takes the bottom
  for (const Vec3& from : {Vec3(1, 0, 0), Vec3(0, -1, 0.1f), Vec3(0.1f, 0, 1)}) {
    const Image image = s.seen(camera_at(from), cut);
    for (int y = kSide / 2 - 6; y < kSide / 2 + 6; ++y) {
      for (int x = kSide / 2 - 6; x < kSide / 2 + 6; ++x) {
        ASSERT_GT(image.at(x, y)[3], 0.97f) << x << ", " << y;
      }
    }
  }
}

// A convex body shadows nothing of itself: under a sky as bright everywhere it is so too, and a key
// light from the left is seen on the left.
TEST(Surface, IsLitByTheRig) {
  LitBall s;
  s.section.rig.keys.clear();
  s.section.rig.sky_top = s.section.rig.sky_horizon = s.section.rig.sky_bottom = Vec3(0.3f);
  s.openings.set_rig(s.section.rig);
  const Camera camera = camera_at({0, -1, 0});
  const auto brightness = [&](const Image& image, float x, float y) {
    return image.at(static_cast<int>(x * kSide), static_cast<int>(y * kSide))[1];
  };
  const Image even = s.seen(camera, Cut());
  for (const Vec2 at : {Vec2(0.3f, 0.5f), Vec2(0.7f, 0.5f), Vec2(0.5f, 0.3f), Vec2(0.5f, 0.7f)}) {
    EXPECT_NEAR(brightness(even, at.x, at.y) / brightness(even, 0.5f, 0.5f), 1, 0.05);
  }
  s.section.rig.keys = {{Vec3(-1, 0, 0), Vec3(1), 0.1f}};
  s.openings.set_rig(s.section.rig);
  const Image keyed = s.seen(camera, Cut());
  EXPECT_GT(brightness(keyed, 0.25f, 0.5f), 1.2f * brightness(keyed, 0.75f, 0.5f));
  EXPECT_NEAR(brightness(keyed, 0.75f, 0.5f), brightness(even, 0.75f, 0.5f), 0.05f);
}

TEST(Surface, FadesWithItsOwnDepth) {
  const LitBall s;
  const Camera camera = camera_at({0, -1, 0});
  const float away = glm::length(camera.position);
  const DepthCue cue{0.8f, away - 30, away};
  const Image plain = s.seen(camera, Cut());
  const Image faded = s.seen(camera, Cut(), cue);
  const float kept = cue.kept(away - 15);  // of the nearest point, to half a voxel
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(faded.at(kSide / 2, kSide / 2)[c], kept * plain.at(kSide / 2, kSide / 2)[c], 0.02);
  }
  EXPECT_EQ(sum_of_alpha(faded), sum_of_alpha(plain));
}

TEST(Surface, LeavesFacesOut) {
  const LitBall s;
  const Cut cut(Plane{Vec3(0, 1, 0), 0});
  const Camera camera = camera_at({0, -1, 0});  // straight at the face
  const Image image = s.seen(camera, cut);
  const FaceOptions options;
  const Image faces = draw_faces(s.section, camera, cut, options);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (faces.at(x, y)[3] > 0.999f) {
        EXPECT_EQ(image.at(x, y)[3], 0) << x << ' ' << y;
      }
    }
  }
  // From the other side the plane cuts nothing off that is seen.
  const Camera behind = camera_at({0, 1, 0});
  EXPECT_NEAR(sum_of_alpha(s.seen(behind, cut)), sum_of_alpha(s.seen(behind, Cut())), 30);
}

}  // namespace
}  // namespace clipgs
