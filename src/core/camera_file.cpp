#include "core/camera_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"

namespace clipgs {

namespace {

constexpr int kMostPixels = 16384;  // a side
constexpr float kRigid = 1e-3f;     // of the product of two axes, which should be 0 or 1

Mat4 rigid_matrix(const JsonReader& reader, const char* key) {
  const Mat4 matrix(reader.matrix(key));
  const Mat3 rotation(matrix);
  const Mat3 error = glm::transpose(rotation) * rotation - Mat3(1);
  for (int i = 0; i < 3; ++i) {
    if (!(glm::length(error[i]) < kRigid) || !std::isfinite(matrix[3][i])) {
      reader.fail(key, "a rigid 4x4 camera-to-world matrix");
    }
  }
  return matrix;
}

}  // namespace

Camera read_camera(const JsonReader& reader) {
  Camera camera;
  camera.width = reader.integer("w", 1, kMostPixels);
  camera.height = reader.integer("h", 1, kMostPixels);
  camera.fx = reader.positive("fl_x");
  camera.fy = reader.positive("fl_y");
  camera.cx = reader.number("cx");
  camera.cy = reader.number("cy");
  camera.set_opengl_camera_to_world(rigid_matrix(reader, "transform_matrix"));
  return camera;
}

Camera read_camera(const std::filesystem::path& path) {
  const nlohmann::json object = nlohmann::json::parse(read_text(path), nullptr, false);
  return read_camera(JsonReader(object, path.string()));
}

}  // namespace clipgs
