#include "core/camera_file.h"

#include <filesystem>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {
namespace {

using nlohmann::json;

class CameraFile : public testing::Test {
 protected:
  CameraFile() {
    const Mat4 m =
        frame_sphere({{10, -20, 30}, 80}, View{30, 20, 1.5f}, 400, 300).opengl_camera_to_world();
    for (int r = 0; r < 4; ++r) {
      whole_["transform_matrix"].push_back({m[0][r], m[1][r], m[2][r], m[3][r]});
    }
  }
  ~CameraFile() override { std::filesystem::remove(path_); }

  Camera read(const std::function<void(json&)>& change = {}) {
    json changed = whole_;
    if (change) {
      change(changed);
    }
    write_text(path_, changed.dump());
    return read_camera(path_);
  }

  void expect_refused(const std::function<void(json&)>& change, const char* key) {
    try {
      read(change);
      ADD_FAILURE() << key << " was read";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(key));
    }
  }

  json whole_ = {{"w", 400}, {"h", 300}, {"fl_x", 500}, {"fl_y", 510}, {"cx", 190.5}, {"cy", 155}};
  // Tests run side by side, each a process: a name of its own.
  std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) /
                                ("clipgs-camera-" + std::to_string(getpid()) + ".json");
};

TEST_F(CameraFile, HasTheKeysOfADatasetsFrame) {
  const Camera camera = read();
  EXPECT_EQ(camera.width, 400);
  EXPECT_EQ(camera.height, 300);
  EXPECT_EQ(camera.fx, 500);
  EXPECT_EQ(camera.fy, 510);
  EXPECT_EQ(camera.cx, 190.5f);
  EXPECT_EQ(camera.cy, 155);
  const Camera same = frame_sphere({{10, -20, 30}, 80}, View{30, 20, 1.5f}, 400, 300);
  EXPECT_NEAR(glm::distance(camera.position, same.position), 0, 1e-3);
  EXPECT_NEAR(glm::dot(camera.forward(), same.forward()), 1, 1e-6);
}

TEST_F(CameraFile, RefusesWhatIsNoCamera) {
  expect_refused([](json& c) { c.erase("w"); }, "w");
  expect_refused([](json& c) { c["h"] = 100000; }, "h");
  expect_refused([](json& c) { c["fl_x"] = 0; }, "fl_x");
  expect_refused([](json& c) { c["cy"] = "middle"; }, "cy");
  expect_refused([](json& c) { c["transform_matrix"][1][1] = 2; }, "transform_matrix");
  expect_refused([](json& c) { c["transform_matrix"][0][3] = 1e300; }, "transform_matrix");
  expect_refused([](json& c) { c["transform_matrix"].erase(3); }, "transform_matrix");
  write_text(path_, "no json");
  EXPECT_THROW(read_camera(path_), Error);
}

}  // namespace
}  // namespace clipgs
