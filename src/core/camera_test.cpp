#include "core/camera.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

TEST(Camera, FrontViewShowsPatientsRightOnTheLeft) {
  const Camera camera = frame_sphere({{0, 0, 0}, 100}, View{0, 0, 1}, 200, 200);
  EXPECT_NEAR(glm::dot(camera.forward(), Vec3(0, -1, 0)), 1, 1e-5);
  const Vec3 right = camera.to_camera({50, 0, 0});
  EXPECT_LT(right.x, 0);                             // patient's right: left in the picture
  EXPECT_LT(camera.to_camera({0, 0, 50}).y, 0);      // superior is up
  EXPECT_GT(camera.to_camera({0, 0, 0}).z, 100.0f);  // outside the sphere
}

TEST(Camera, SphereFillsNineTenthsOfTheShorterSide) {
  const Sphere sphere{{10, -20, 30}, 80};
  const Camera camera = frame_sphere(sphere, View{30, 20, 1}, 400, 300);
  // The silhouette circle: tangent points of the cone from the camera.
  const float distance = glm::length(camera.position - sphere.center);
  const float half_angle = std::asin(sphere.radius / distance);
  EXPECT_NEAR(camera.fx * std::tan(half_angle), 0.45f * 300, 0.1f);
}

TEST(Camera, RayDirectionInvertsProjection) {
  const Camera camera = frame_sphere({{0, 0, 0}, 50}, View{120, -35, 1.5f}, 320, 240);
  const Vec3 p = camera.position + 77.0f * camera.ray_direction(100.25f, 31.5f);
  const Vec3 t = camera.to_camera(p);
  EXPECT_NEAR(camera.fx * t.x / t.z + camera.cx, 100.25f, 1e-2);
  EXPECT_NEAR(camera.fy * t.y / t.z + camera.cy, 31.5f, 1e-2);
}

TEST(Camera, OpenGlMatrixRoundTrips) {
  const Camera camera = frame_sphere({{1, 2, 3}, 50}, View{75, 89.999f, 1}, 64, 64);
  Camera copy = camera;
  copy.set_opengl_camera_to_world(camera.opengl_camera_to_world());
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(glm::length(copy.rotation[c] - camera.rotation[c]), 0, 1e-6);
  }
  EXPECT_EQ(copy.position, camera.position);
}

TEST(Camera, LookingStraightDownIsStillARotation) {
  const Camera camera = frame_sphere({{0, 0, 0}, 50}, View{0, 90, 1}, 64, 64);
  EXPECT_NEAR(glm::determinant(camera.rotation), 1, 1e-5);
}

TEST(Geometry, FibonacciSphereIsEven) {
  Vec3 sum(0);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = fibonacci_sphere(i, 500);
    EXPECT_NEAR(glm::length(p), 1, 1e-5);
    sum += p;
  }
  EXPECT_LT(glm::length(sum) / 500, 0.01f);
}

TEST(Geometry, ProjectBoxBoundsTheCorners) {
  Box box;
  box.add({-1, -2, -3});
  box.add({4, 5, 6});
  const Vec2 interval = project_box(box, glm::normalize(Vec3(1, -1, 0)));
  EXPECT_NEAR(interval.x, (-1 - 5) / std::sqrt(2.0f), 1e-5);
  EXPECT_NEAR(interval.y, (4 + 2) / std::sqrt(2.0f), 1e-5);
}

}  // namespace
}  // namespace clipgs
