#include "core/camera_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/json_reader.h"

namespace clipgs {

namespace {

constexpr int kMostPixels = 8192;  // a side
constexpr float kRigid = 1e-3f;    // of the product of two axes, which should be 0 or 1

float positive(const JsonReader& reader, const char* key) {
  const float value = reader.number(key);
  if (value <= 0) {
    reader.fail(key);
  }
  return value;
}

Mat4 rigid_matrix(const JsonReader& reader, const char* key) {
  const Mat4 matrix(reader.matrix(key));
  const Mat3 rotation(matrix);
  const Mat3 error = glm::transpose(rotation) * rotation - Mat3(1);
  for (int i = 0; i < 3; ++i) {
    if (!(glm::length(error[i]) < kRigid) || !std::isfinite(matrix[3][i])) {
      reader.fail(key);
    }
  }
  return matrix;
}

}  // namespace

Camera read_camera(const std::filesystem::path& path) {
  const nlohmann::json object = nlohmann::json::parse(read_text(path), nullptr, false);
  const JsonReader reader(object, path.string());
  Camera camera;
  camera.width = reader.integer("w", 1, kMostPixels);
  camera.height = reader.integer("h", 1, kMostPixels);
  camera.fx = positive(reader, "fl_x");
  camera.fy = positive(reader, "fl_y");
  camera.cx = reader.number("cx");
  camera.cy = reader.number("cy");
  camera.set_opengl_camera_to_world(rigid_matrix(reader, "transform_matrix"));
  return camera;
}

}  // namespace clipgs
