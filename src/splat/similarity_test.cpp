#include "splat/similarity.h"

#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "splat/sh.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

Similarity oblique() {
  Similarity s;
  s.rotation = glm::dmat3(glm::mat3_cast(glm::normalize(glm::dquat(0.3, -0.5, 0.7, 0.2))));
  s.scale = 2.5;
  s.translation = {1, -2, 3};
  return s;
}

TEST(Similarity, SceneSpaceShowsThePatientUprightAndFacingTheViewer) {
  const Similarity world_to_scene = scene_to_world().inverse();
  EXPECT_NEAR(glm::determinant(world_to_scene.rotation), 1, 1e-12);
  const Vec3 p = world_to_scene.apply(Vec3(100, 20, 3000));  // R, A, S
  EXPECT_NEAR(p.x, -0.1, 1e-6);   // the patient's right is on the viewer's left
  EXPECT_NEAR(p.y, -3.0, 1e-6);   // y points down, the head up
  EXPECT_NEAR(p.z, -0.02, 1e-6);  // the face is nearer than the back
}

TEST(Similarity, MatrixRoundTrip) {
  const Similarity s = oblique();
  const Similarity back = Similarity::from_matrix(s.matrix());
  EXPECT_NEAR(back.scale, s.scale, 1e-12);
  for (int c = 0; c < 3; ++c) {
    EXPECT_LT(glm::length(back.rotation[c] - s.rotation[c]), 1e-12);
  }
  EXPECT_EQ(back.translation, s.translation);
  const Vec3 p(4, 5, -6);
  EXPECT_LT(glm::length(s.inverse().apply(s.apply(p)) - p), 1e-5f);
}

TEST(Similarity, RefusesWhatIsNoSimilarity) {
  glm::dmat4 mirror(1);
  mirror[0][0] = -1;
  EXPECT_THROW(Similarity::from_matrix(mirror), Error);
  glm::dmat4 uneven(1);
  uneven[0][0] = 2;
  EXPECT_THROW(Similarity::from_matrix(uneven), Error);
  EXPECT_THROW(Similarity::from_matrix(glm::dmat4(0)), Error);
  glm::dmat4 nan(1);
  nan[3][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Similarity::from_matrix(nan), Error);
  glm::dmat4 perspective(1);
  perspective[0][3] = 0.5;
  EXPECT_THROW(Similarity::from_matrix(perspective), Error);
}

TEST(Transform, ColourTurnsWithTheGaussian) {
  for (int degree = 0; degree <= kMaxShDegree; ++degree) {
    const Gaussians before = random_gaussians(20, degree, 1);
    for (const Similarity& s : {oblique(), scene_to_world(), scene_to_world().inverse()}) {
      const Gaussians after = transform(before, s);
      for (size_t i = 0; i < before.size(); ++i) {
        const Vec3 d = fibonacci_sphere(static_cast<int>(i), 20);
        const Vec3 turned(s.rotation * glm::dvec3(d));
        EXPECT_LT(glm::length(sh_color(before, i, d) - sh_color(after, i, turned)), 2e-6f);
      }
    }
  }
}

TEST(Transform, FaceColourTurnsWithThePlane) {
  const Gaussians before = random_faces(20, 2, 1);
  for (const Similarity& s : {oblique(), scene_to_world()}) {
    const Gaussians after = transform(before, s);
    for (size_t i = 0; i < before.size(); ++i) {
      const Vec3 n = fibonacci_sphere(static_cast<int>(i), 20);
      const Vec3 turned(s.rotation * glm::dvec3(n));
      EXPECT_GT(glm::length(face_color(before, i, n)), 1e-3f);
      EXPECT_LT(glm::length(face_color(before, i, n) - face_color(after, i, turned)), 2e-6f);
    }
  }
}

TEST(Transform, CovarianceTurnsAndScales) {
  const Gaussians before = random_gaussians(20, 0, 2);
  const Similarity s = oblique();
  const Gaussians after = transform(before, s);
  const Mat3 r(s.rotation);
  for (size_t i = 0; i < before.size(); ++i) {
    const Mat3 expected = 6.25f * (r * before.covariance(i) * glm::transpose(r));
    const float size = glm::length(Vec3(expected[0][0], expected[1][1], expected[2][2]));
    for (int c = 0; c < 3; ++c) {
      EXPECT_LT(glm::length(after.covariance(i)[c] - expected[c]), 1e-5f * size);
    }
    EXPECT_LT(glm::length(after.mean(i) - s.apply(before.mean(i))), 1e-3f);
    EXPECT_EQ(after.opacity(i), before.opacity(i));
  }
}

TEST(Transform, ThereAndBackIsTheSame) {
  const Gaussians before = random_gaussians(50, 3, 3);
  const Gaussians after =
      transform(transform(before, scene_to_world().inverse()), scene_to_world());
  for (int p = 0; p < before.planes(); ++p) {
    if (p >= Gaussians::kRotation && p < Gaussians::kOpacity) {
      continue;  // the quaternion is normalised on the way
    }
    for (size_t i = 0; i < before.size(); ++i) {
      EXPECT_NEAR(after.plane(p)[i], before.plane(p)[i],
                  1e-6f * std::max(1.0f, std::abs(before.plane(p)[i])));
    }
  }
}

}  // namespace
}  // namespace clipgs
