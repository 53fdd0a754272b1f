// Opens a case, cuts it obliquely through its middle, and writes what a camera sees.
//
//   cut_and_draw CASE.sog PICTURE.png

#include <cstdio>
#include <exception>

#include "asset/case.h"
#include "asset/draw_case.h"
#include "core/camera.h"
#include "core/image.h"

namespace {

void cut_and_draw(const char* case_path, const char* picture_path) {
  clipgs::Case contents = clipgs::load_case(case_path);
  clipgs::prepare_openings(contents);  // what a cut opens is drawn from the volume, too

  // World space is the patient's: x right, y anterior, z superior, in mm. What lies on the side
  // that the normal points to is kept; here the front of the left upper half is taken away.
  const clipgs::Sphere& body = contents.scene.sphere;
  clipgs::Plane plane;
  plane.normal = glm::normalize(clipgs::Vec3(1, -2, -1));
  plane.offset = glm::dot(plane.normal, body.center);

  const clipgs::View view{.azimuth_deg = 20, .elevation_deg = 15, .zoom = 1};
  const clipgs::Camera camera = clipgs::frame_sphere(body, view, 1024, 1024);
  const clipgs::Image picture = clipgs::draw_case(contents, camera, plane);
  clipgs::write_png(picture_path, clipgs::composite(picture, 1, 1, 1));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: cut_and_draw CASE.sog PICTURE.png\n");
    return 2;
  }
  try {
    cut_and_draw(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cut_and_draw: %s\n", error.what());
    return 1;
  }
}
