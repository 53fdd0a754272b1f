#include "cinema/dataset.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {
namespace {

using Json = nlohmann::json;

constexpr std::array kSplits{Split::kTrain, Split::kTestAxis, Split::kTestOblique};
constexpr int kMaxSide = 16384;
constexpr float kUnitTolerance = 1e-3f;

// Reads checked values out of transforms.json; every error names the file and the key.
class Reader {
 public:
  Reader(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json_.is_object()) {
      throw Error("{}: not an object; make the dataset again", where_);
    }
  }

  bool has(const char* key) const { return json_.contains(key) && !json_.at(key).is_null(); }

  const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) {
      throw Error("{}: \"{}\" is missing; make the dataset again", where_, key);
    }
    return *found;
  }

  Reader object(const char* key) const { return {at(key), where_ + ", \"" + key + '"'}; }

  std::string text(const char* key) const {
    if (!at(key).is_string()) {
      fail(key, "a text");
    }
    return at(key).get<std::string>();
  }

  float number(const char* key) const { return numbers<1>(key, Json::array({at(key)}))[0]; }

  int side(const char* key) const {
    const float value = number(key);
    if (value < 1 || value > kMaxSide || value != std::floor(value)) {
      fail(key, "a whole number of pixels");
    }
    return static_cast<int>(value);
  }

  template <size_t kCount>
  std::array<float, kCount> numbers(const char* key) const {
    return numbers<kCount>(key, at(key));
  }

  Vec3 vector(const char* key) const {
    const std::array<float, 3> v = numbers<3>(key);
    return {v[0], v[1], v[2]};
  }

  Vec3 unit_vector(const char* key) const {
    const Vec3 v = vector(key);
    if (std::abs(glm::length(v) - 1.0f) > kUnitTolerance) {
      fail(key, "a unit vector");
    }
    return v;
  }

  /// A path inside the dataset's folder.
  std::string file(const char* key) const {
    const std::filesystem::path path = text(key);
    bool inside = !path.empty() && path.is_relative();
    for (const std::filesystem::path& part : path) {
      inside = inside && part != "..";
    }
    if (!inside) {
      fail(key, "a path inside the dataset's folder");
    }
    return path.string();
  }

  [[noreturn]] void fail(const char* key, const char* expected) const {
    throw Error("{}: \"{}\" is not {}; make the dataset again", where_, key, expected);
  }

 private:
  template <size_t kCount>
  std::array<float, kCount> numbers(const char* key, const Json& list) const {
    std::array<float, kCount> values{};
    bool valid = list.is_array() && list.size() == kCount;
    for (size_t i = 0; valid && i < kCount; ++i) {
      valid = list[i].is_number();
      if (valid) {
        values[i] = list[i].get<float>();
        valid = std::isfinite(values[i]);
      }
    }
    if (!valid) {
      throw Error("{}: \"{}\" is not {} finite number(s); make the dataset again", where_, key,
                  kCount);
    }
    return values;
  }

  const Json& json_;
  std::string where_;
};

Mat4 read_matrix(const Reader& reader, const char* key) {
  const Json& rows = reader.at(key);
  Mat4 matrix(1);
  bool valid = rows.is_array() && rows.size() == 4;
  for (int r = 0; valid && r < 4; ++r) {
    const Json& row = rows[static_cast<size_t>(r)];
    valid = row.is_array() && row.size() == 4;
    for (int c = 0; valid && c < 4; ++c) {
      const Json& value = row[static_cast<size_t>(c)];
      valid = value.is_number() && std::isfinite(value.get<float>());
      if (valid) {
        matrix[c][r] = value.get<float>();
      }
    }
  }
  const Mat3 rotation(matrix);
  const Mat3 error = glm::transpose(rotation) * rotation - Mat3(1);
  for (int i = 0; i < 3; ++i) {
    valid = valid && glm::length(error[i]) < kUnitTolerance;
  }
  if (!valid) {
    reader.fail(key, "a rigid 4x4 camera-to-world matrix");
  }
  return matrix;
}

Split read_split(const Reader& reader) {
  const std::string name = reader.text("split");
  for (const Split split : kSplits) {
    if (name == split_name(split)) {
      return split;
    }
  }
  reader.fail("split", "train, test_axis or test_oblique");
}

Frame read_frame(const Reader& reader) {
  Frame frame;
  Camera& camera = frame.camera;
  camera.width = reader.side("w");
  camera.height = reader.side("h");
  camera.fx = reader.number("fl_x");
  camera.fy = reader.number("fl_y");
  camera.cx = reader.number("cx");
  camera.cy = reader.number("cy");
  if (camera.fx <= 0 || camera.fy <= 0) {
    reader.fail("fl_x", "a positive focal length (nor fl_y)");
  }
  camera.set_opengl_camera_to_world(read_matrix(reader, "transform_matrix"));
  if (reader.has("clip_plane")) {
    const std::array<float, 4> p = reader.numbers<4>("clip_plane");
    frame.plane = Plane{Vec3(p[0], p[1], p[2]), p[3]};
    if (std::abs(glm::length(frame.plane->normal) - 1.0f) > kUnitTolerance) {
      reader.fail("clip_plane", "a unit normal and an offset");
    }
  }
  frame.split = read_split(reader);
  frame.file = reader.file("file_path");
  if (reader.has("uncut_file_path")) {
    frame.uncut_file = reader.file("uncut_file_path");
  }
  if (reader.has("depth_file_path")) {
    frame.depth_file = reader.file("depth_file_path");
  }
  frame.noise_db = reader.number("noise_db");
  frame.masked_noise_db = reader.number("masked_noise_db");
  return frame;
}

}  // namespace

const char* split_name(Split split) {
  switch (split) {
    case Split::kTrain:
      return "train";
    case Split::kTestAxis:
      return "test_axis";
    case Split::kTestOblique:
      return "test_oblique";
  }
  return "";
}

std::vector<const Frame*> Dataset::split(Split which) const {
  std::vector<const Frame*> chosen;
  for (const Frame& frame : frames) {
    if (frame.split == which) {
      chosen.push_back(&frame);
    }
  }
  return chosen;
}

Image Dataset::load(const Frame& frame) const {
  const std::filesystem::path path = folder / frame.file;
  Image image = read_png(path);
  if (image.width != frame.camera.width || image.height != frame.camera.height ||
      image.channels != 4) {
    throw Error("{}: {}x{} pixels of {} channels, but transforms.json says {}x{} of 4",
                path.string(), image.width, image.height, image.channels, frame.camera.width,
                frame.camera.height);
  }
  return image;
}

Dataset load_dataset(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "transforms.json";
  if (!std::filesystem::exists(path)) {
    throw Error(
        "{}: no dataset here (no transforms.json); make one with 'clipgs dataset VOLUME -o {}'",
        folder.string(), folder.string());
  }
  const Json json = Json::parse(read_text(path), nullptr, false);
  if (json.is_discarded()) {
    throw Error("{}: not valid JSON; make the dataset again", path.string());
  }
  const Reader top(json, path.string());
  Dataset dataset;
  dataset.folder = folder;
  dataset.axis = top.unit_vector("axis");
  const std::array<float, 2> extent = top.numbers<2>("extent");
  dataset.extent = {extent[0], extent[1]};
  const Reader sphere = top.object("sphere");
  dataset.sphere = {sphere.vector("center"), sphere.number("radius")};
  const Reader bounds = top.object("bounds");
  dataset.bounds.min = bounds.vector("min");
  dataset.bounds.max = bounds.vector("max");
  const Vec3 spacing = top.object("volume").vector("spacing");
  dataset.voxel_mm = std::cbrt(spacing.x * spacing.y * spacing.z);
  dataset.preset = top.text("preset");
  dataset.depth_scale = top.number("depth_scale");
  if (!(dataset.extent.x < dataset.extent.y) || !(dataset.sphere.radius > 0) ||
      !(dataset.voxel_mm > 0)) {
    throw Error("{}: extent, sphere or spacing is empty; make the dataset again", path.string());
  }
  const Json& frames = top.at("frames");
  if (!frames.is_array() || frames.empty()) {
    top.fail("frames", "a list of frames");
  }
  for (size_t i = 0; i < frames.size(); ++i) {
    dataset.frames.push_back(
        read_frame(Reader(frames[i], fmt::format("{}, frame {}", path.string(), i))));
  }
  return dataset;
}

}  // namespace clipgs
