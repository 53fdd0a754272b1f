#include "measure/cut_face.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/error.h"

namespace clipgs {
namespace {

constexpr int kSide = 64;
const Sphere kBody{Vec3(3, -4, 5), 50};

/// Seen along the plane z = 5, which keeps what is above it, from `degrees` above.
Camera along_the_plane(float degrees) {
  const float angle = degrees * 0.0174532925f;
  const Vec3 from(0, -std::cos(angle), std::sin(angle));
  return frame_sphere(kBody, from, 1, kSide, kSide);
}
const Plane kKeepsAbove{Vec3(0, 0, 1), 5};

Image grey(float value) {
  Image image(kSide, kSide, 3);
  std::fill(image.data.begin(), image.data.end(), value);
  return image;
}

void paint_rows(Image& image, int from, int to, float value) {
  std::fill(image.at(0, from), image.at(0, from) + 3 * kSide * (to - from), value);
}

TEST(CutFace, EdgeOfAPlaneThroughTheCameraIsItsLine) {
  const Camera camera = along_the_plane(0);
  const Image distances = distance_from_edge(camera, kKeepsAbove, kBody);
  for (int y = 0; y < kSide; ++y) {
    // The plane is the picture's middle, and what it keeps is above.
    EXPECT_NEAR(*distances.at(7, y), static_cast<float>(y) + 0.5f - 0.5f * kSide, 1e-3f);
  }
  // The other side is that of the other plane.
  const Image other = distance_from_edge(camera, {Vec3(0, 0, -1), -5}, kBody);
  EXPECT_NEAR(*other.at(9, 3), -*distances.at(9, 3), 1e-3f);
}

TEST(CutFace, EdgeSeenAtASlantIsNearWhereTheBodyHasIt) {
  const Camera camera = along_the_plane(1.5f);
  const Image distances = distance_from_edge(camera, kKeepsAbove, kBody);
  EXPECT_NEAR(*distances.at(kSide / 2, kSide / 2), 0.5f, 1);
  EXPECT_LT(*distances.at(kSide / 2, 4), -20);
}

TEST(CutFace, PlanesSeenStraightHaveNoEdge) {
  const Camera camera = frame_sphere(kBody, Vec3(0, -1, 0), 1, kSide, kSide);
  const Image distances = distance_from_edge(camera, {Vec3(0, 1, 0), -4}, kBody);
  for (const float distance : distances.data) {
    EXPECT_EQ(distance, 0);
  }
}

TEST(CutFace, CountsWhatLeaksBeyondTheEdge) {
  const Camera camera = along_the_plane(0.1f);
  Image truth = grey(0);
  paint_rows(truth, 0, 32, 0.5f);
  Image picture = truth;
  paint_rows(picture, 32, 34, 0.3f);  // as near as that is the edge itself
  paint_rows(picture, 36, 40, 0.2f);
  const Image uncut = grey(0.5f);
  const CutFace seen = cut_face({truth, uncut, picture, uncut, camera, kKeepsAbove}, kBody);
  EXPECT_EQ(seen.faces, 0U);
  EXPECT_NEAR(seen.leaked, 4 * kSide * 0.2, 1e-3);
  EXPECT_NEAR(seen.near_edge, kSide * (32 * 0.5 + 2 * 0.3 + 4 * 0.2), 1e-2);
  EXPECT_NEAR(*seen.leak_percent(), 100 * 0.8 / 17.4, 1e-3);
  // Twelve rows below the edge are gone in the truth, and all of them changed in the picture, too.
  EXPECT_NEAR(static_cast<double>(seen.edge.changed), 12 * kSide, kSide);
  EXPECT_EQ(seen.edge.missed + seen.edge.extra, 0U);
  EXPECT_EQ(seen.face.changed, 0U);
}

TEST(CutFace, CountsWhatACutChangesOtherwise) {
  const Camera camera = frame_sphere(kBody, Vec3(0.1f, 0.1f, -1), 1, kSide, kSide);
  Image truth = grey(0.2f);
  Image picture = grey(0.2f);
  const Image uncut = grey(0.3f);
  paint_rows(truth, 0, 16, 0.3f);     // not changed here,
  paint_rows(picture, 8, 24, 0.29f);  // nor there
  const CutFace seen = cut_face({truth, uncut, picture, uncut, camera, kKeepsAbove}, kBody);
  EXPECT_EQ(seen.face.changed, static_cast<size_t>(48 * kSide));
  EXPECT_EQ(seen.face.missed, static_cast<size_t>(8 * kSide));
  EXPECT_EQ(seen.face.extra, static_cast<size_t>(8 * kSide));
  EXPECT_NEAR(*seen.face.percent(), 100 * 16.0 / 48, 1e-9);
  EXPECT_FALSE(seen.edge.percent());
}

TEST(CutFace, SsimIsOfOneWindowOverWhatTheTruthShows) {
  const Camera camera = frame_sphere(kBody, Vec3(0.1f, 0.1f, -1), 1, kSide, kSide);
  Image truth = grey(0);
  Image picture = grey(0.9f);  // where the truth shows nothing it does not count
  paint_rows(truth, 10, 20, 0.2f);
  paint_rows(truth, 20, 30, 0.6f);
  paint_rows(picture, 10, 20, 0.3f);
  paint_rows(picture, 20, 30, 0.5f);
  const CutFace seen = cut_face({truth, truth, picture, picture, camera, kKeepsAbove}, kBody);
  // Means 0.4 and 0.4, variances 0.04 and 0.01, covariance 0.02.
  const double expected = (2 * 0.02 + 0.0009) / (0.05 + 0.0009);
  EXPECT_NEAR(*seen.ssim(), expected, 1e-6);
  CutFace sum = seen;
  sum.add(cut_face({truth, truth, truth, truth, camera, kKeepsAbove}, kBody));
  EXPECT_NEAR(*sum.ssim(), 0.5 * (expected + 1), 1e-6);
}

TEST(CutFace, RefusesPicturesOfOtherSizes) {
  const Camera camera = along_the_plane(1.5f);
  const Image a = grey(0);
  const Image b(8, 8, 3);
  EXPECT_THROW(cut_face({a, a, b, a, camera, kKeepsAbove}, kBody), Error);
}

}  // namespace
}  // namespace clipgs
