#include "measure/pixel_classes.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

constexpr int kSize = 64;
constexpr float kTolerance = 0.5f;  // mm

/// A hollow ball around the origin, in a box: the nearest of the distances at which the ray meets
/// its shell (radii 30 and 40 mm) within what the plane keeps and |z| ≤ end; 0 if it meets none.
/// The slow and obvious way: a march.
float march(const Camera& camera, const Vec3& ray, const Plane* plane, float end) {
  for (float t = 0; t < 400; t += 0.05f) {
    const Vec3 x = camera.position + t * ray;
    const float radius = glm::length(x);
    const bool kept = plane == nullptr || plane->signed_distance(x) >= 0;
    if (kept && std::abs(x.z) <= end && radius >= 30 && radius <= 40) {
      return t;
    }
  }
  return 0;
}

Image first_hits(const Camera& camera, const Plane* plane, float end) {
  Image hits(kSize, kSize, 1);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Vec3 ray =
          camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      *hits.at(x, y) = march(camera, ray, plane, end);
    }
  }
  return hits;
}

class PixelClassesTest : public testing::Test {
 protected:
  Camera camera_ = frame_sphere({{0, 0, 0}, 45}, View{0, 0}, kSize, kSize);  // from +y, anterior
  Plane plane_{{0, -1, 0}, 0};  // what faces the camera is taken away

  std::vector<PixelClass> classify(float end, const std::vector<Plane>& ends = {}) const {
    return classify_pixels({first_hits(camera_, &plane_, end), first_hits(camera_, nullptr, end)},
                           camera_, plane_, ends, kTolerance);
  }
  /// The class of what is seen at a point of the plane y = 0.
  PixelClass at(const std::vector<PixelClass>& classes, float x, float z) const {
    const Vec3 seen = camera_.to_camera({x, 0, z});
    const int u = static_cast<int>(camera_.fx * seen.x / seen.z + camera_.cx);
    const int v = static_cast<int>(camera_.fy * seen.y / seen.z + camera_.cy);
    return classes[static_cast<size_t>(v) * kSize + static_cast<size_t>(u)];
  }
};

TEST_F(PixelClassesTest, AHollowBallIsAFaceAroundAnOpening) {
  const std::vector<PixelClass> classes = classify(100);
  EXPECT_EQ(at(classes, 0, 0), PixelClass::kOpened);
  EXPECT_EQ(at(classes, 20, 10), PixelClass::kOpened);
  EXPECT_EQ(at(classes, 35, 0), PixelClass::kFace);
  EXPECT_EQ(at(classes, 0, -36), PixelClass::kFace);
  EXPECT_EQ(classes.front(), PixelClass::kOutside);  // nothing with or without the plane
  // A face is a ring of radii 30 and 40 mm about: the opening's share is as large as the disc's.
  const auto count = [&](PixelClass which) { return std::ranges::count(classes, which); };
  EXPECT_NEAR(static_cast<double>(count(PixelClass::kFace)) /
                  static_cast<double>(count(PixelClass::kOpened)),
              7.0 / 9, 0.1);
}

TEST_F(PixelClassesTest, WhatIsSeenWithoutThePlaneTooIsOutside) {
  plane_ = {{0, 0, -1}, -20};  // the upper cap is taken away; seen from the front
  const std::vector<PixelClass> classes = classify(100);
  EXPECT_EQ(at(classes, 0, 0), PixelClass::kOutside);
  EXPECT_EQ(at(classes, 20, -20), PixelClass::kOutside);
  // From behind a plane nothing is opened, nor is what it bounds its face.
  plane_ = {{0, 1, 0}, 0};
  EXPECT_EQ(std::ranges::count(classify(100), PixelClass::kOutside), kSize * kSize);
}

TEST_F(PixelClassesTest, EndsOfTheVolumeAreFaces) {
  camera_ = frame_sphere({{0, 0, 0}, 45}, View{0, 50}, kSize, kSize);  // from above
  plane_ = {{0, 0, -1}, -100};                                         // takes nothing away
  const float end = 20;
  const std::vector<Plane> ends = {{{0, 0, 1}, -end}, {{0, 0, -1}, -end}};
  const Vec3 rim = camera_.to_camera({0, 28, end});  // √(28² + 20²) = 34: within the shell
  const size_t pixel = static_cast<size_t>(camera_.fy * rim.y / rim.z + camera_.cy) * kSize +
                       static_cast<size_t>(camera_.fx * rim.x / rim.z + camera_.cx);
  EXPECT_EQ(classify(end, ends)[pixel], PixelClass::kFace);
  EXPECT_EQ(classify(end)[pixel], PixelClass::kOutside);
}

TEST_F(PixelClassesTest, HitsOfAnotherSizeAreAnError) {
  EXPECT_THROW(classify_pixels({Image(8, 8, 1), Image(8, 8, 1)}, camera_, plane_, {}, 1), Error);
}

}  // namespace
}  // namespace clipgs
