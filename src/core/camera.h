#pragma once

#include "core/geometry.h"

namespace clipgs {

/// A pinhole camera. Camera axes are x right, y down, z forward; pixel (0,0) is the top-left pixel
/// and its centre lies at image coordinates (0.5, 0.5).
struct Camera {
  int width = 0;
  int height = 0;
  float fx = 0, fy = 0;  ///< focal lengths, px
  float cx = 0, cy = 0;  ///< principal point, px
  Mat3 rotation{1};      ///< world → camera
  Vec3 position{0};      ///< camera centre in world space, mm

  /// World → camera coordinates (mm).
  Vec3 to_camera(const Vec3& world) const { return rotation * (world - position); }
  /// World-space unit direction through image coordinates (x, y) in px.
  Vec3 ray_direction(float x, float y) const {
    return glm::normalize(Vec3((x - cx) / fx, (y - cy) / fy, 1.0f) * rotation);
  }
  Vec3 forward() const { return Vec3(0, 0, 1) * rotation; }

  /// Camera-to-world matrix in the NeRF/OpenGL convention (x right, y up, z backward).
  Mat4 opengl_camera_to_world() const;
  /// Sets rotation and position from such a matrix.
  void set_opengl_camera_to_world(const Mat4& matrix);
};

/// Vertical field of view that the project's framing uses, radians.
constexpr float kFieldOfView = 0.6981317f;  // 40°
/// Share of the frame's shorter side that the bounding sphere fills at zoom 1 (method.md, framing).
constexpr float kFrameFill = 0.9f;

/// A camera at `position` looking at `target`, `up` roughly upwards; `fov` spans the shorter side.
Camera look_at(const Vec3& position, const Vec3& target, const Vec3& up, int width, int height,
               float fov = kFieldOfView);

/// The camera whose pixels are each `factor` × `factor` of this one's; what does not fill one is
/// left out at the right and at the bottom.
Camera shrunk(const Camera& camera, int factor);

/// Where a camera stands, as a person says it. Azimuth 0° looks at the patient from the front
/// (anterior), 90° from the patient's left; elevation 90° from above the head.
struct View {
  float azimuth_deg = 0;
  float elevation_deg = 0;
  float zoom = 1;  ///< 1 frames the sphere; 2 makes it twice as large
};

/// Unit vector from the target towards a camera at that azimuth and elevation.
Vec3 view_direction(float azimuth_deg, float elevation_deg);

/// The distance from a sphere's centre at which it fills kFrameFill of the shorter side.
float framing_distance(float radius, float fov = kFieldOfView);

/// A camera that frames `sphere` from unit `direction` (sphere centre → camera).
Camera frame_sphere(const Sphere& sphere, const Vec3& direction, float zoom, int width, int height);
Camera frame_sphere(const Sphere& sphere, const View& view, int width, int height);

}  // namespace clipgs
