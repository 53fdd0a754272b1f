#include "core/camera.h"

#include <algorithm>
#include <cmath>

namespace clipgs {

Mat4 Camera::opengl_camera_to_world() const {
  Mat4 m(1);
  const Mat3 axes = glm::transpose(rotation);  // columns: camera axes in world space
  m[0] = Vec4(axes[0], 0);
  m[1] = Vec4(-axes[1], 0);
  m[2] = Vec4(-axes[2], 0);
  m[3] = Vec4(position, 1);
  return m;
}

void Camera::set_opengl_camera_to_world(const Mat4& m) {
  rotation = glm::transpose(Mat3(Vec3(m[0]), -Vec3(m[1]), -Vec3(m[2])));
  position = Vec3(m[3]);
}

Camera look_at(const Vec3& position, const Vec3& target, const Vec3& up, int width, int height,
               float fov) {
  const Vec3 forward = glm::normalize(target - position);
  Vec3 right = glm::cross(forward, up);
  if (glm::length(right) < 1e-4f) {
    // Looking along `up`: any horizontal axis will do, the patient's left is a stable choice.
    right = Vec3(-1, 0, 0);
  }
  right = glm::normalize(right);
  const Vec3 down = glm::cross(forward, right);
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.5f * static_cast<float>(std::min(width, height)) / std::tan(0.5f * fov);
  camera.cx = 0.5f * static_cast<float>(width);
  camera.cy = 0.5f * static_cast<float>(height);
  camera.rotation = glm::transpose(Mat3(right, down, forward));
  camera.position = position;
  return camera;
}

Camera shrunk(const Camera& camera, int factor) {
  const auto f = static_cast<float>(factor);
  Camera small = camera;
  small.width /= factor;
  small.height /= factor;
  small.fx /= f;
  small.fy /= f;
  small.cx /= f;
  small.cy /= f;
  return small;
}

Vec3 view_direction(float azimuth_deg, float elevation_deg) {
  const float az = glm::radians(azimuth_deg);
  const float el = glm::radians(elevation_deg);
  return {-std::sin(az) * std::cos(el), std::cos(az) * std::cos(el), std::sin(el)};
}

float framing_distance(float radius, float fov) {
  // The silhouette of a sphere at distance D has the angular radius asin(r/D).
  return radius / std::sin(std::atan(kFrameFill * std::tan(0.5f * fov)));
}

Camera frame_sphere(const Sphere& sphere, const Vec3& direction, float zoom, int width,
                    int height) {
  const float distance = framing_distance(sphere.radius);
  Camera camera =
      look_at(sphere.center + distance * direction, sphere.center, Vec3(0, 0, 1), width, height);
  camera.fx *= zoom;
  camera.fy *= zoom;
  return camera;
}

Camera frame_sphere(const Sphere& sphere, const View& view, int width, int height) {
  return frame_sphere(sphere, view_direction(view.azimuth_deg, view.elevation_deg), view.zoom,
                      width, height);
}

}  // namespace clipgs
