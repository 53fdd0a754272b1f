#include "section/face_splats.h"

#include <cmath>
#include <gtest/gtest.h>

#include "section/faces.h"
#include "section/test_section.h"
#include "splat/render.h"

namespace clipgs {
namespace {

const Sphere kSphere{{0, 0, 0}, 16};

/// dB between what discs and draw_faces() show of what is all face, over black.
double likeness(const Gaussians& discs, const Image& faces, const Camera& camera) {
  const Image seen = render(discs, camera, Cut(), ClipOperator::kExact);
  double squares = 0;
  size_t count = 0;
  for (size_t i = 0; i < faces.pixels(); ++i) {
    if (faces.data[4 * i + 3] > 0.99f) {
      for (size_t c = 0; c < 3; ++c) {
        squares += std::pow(seen.data[4 * i + c] * seen.data[4 * i + 3] - faces.data[4 * i + c], 2);
        ++count;
      }
    }
  }
  EXPECT_GT(count, 300);
  return -10 * std::log10(squares / static_cast<double>(count));
}

TEST(FaceSplats, ShowTheFacesOfACut) {
  const Section section = test::ball_section();
  const Cut cut(Plane{glm::normalize(Vec3(0.2f, 0.1f, -1)), -2});
  const Gaussians discs = face_splats(section, kSphere, cut, 20000);
  EXPECT_GT(discs.size(), 100);
  EXPECT_LE(discs.size(), 20000);
  for (const View view : {View{0, 80, 1}, View{40, 50, 1}}) {
    const Camera camera = frame_sphere(kSphere, view, 96, 96);
    EXPECT_GT(likeness(discs, draw_faces(section, camera, cut), camera), 28);
  }
}

TEST(FaceSplats, LieInTheirPlanesAndTakeNoMoreThanTheyMay) {
  const Section section = test::ball_section();
  const Plane plane{{0, 0, -1}, -5};
  const Cut cut(std::vector{plane, Plane{{1, 0, 0}, 0}});
  const Gaussians fine = face_splats(section, kSphere, cut, 100'000);
  const Gaussians coarse = face_splats(section, kSphere, cut, fine.size() / 2);
  EXPECT_LE(coarse.size(), fine.size() / 2);
  for (size_t i = 0; i < fine.size(); ++i) {
    const float off =
        std::min(std::abs(plane.signed_distance(fine.mean(i))), std::abs(fine.mean(i).x));
    EXPECT_LT(off, 0.05f);
    for (const Plane& one : cut.planes()) {
      EXPECT_GT(one.signed_distance(fine.mean(i)), -1);
    }
  }
}

TEST(FaceSplats, AreNoneWhereNothingIsCutAndNothingEnds) {
  const Section section = test::ball_section();
  ASSERT_TRUE(section.ends().empty());
  EXPECT_EQ(face_splats(section, kSphere, Cut(), 1000).size(), 0);
  EXPECT_EQ(face_splats(section, kSphere, Cut(Plane{{0, 0, 1}, -200}), 1000).size(), 0);
}

}  // namespace
}  // namespace clipgs
