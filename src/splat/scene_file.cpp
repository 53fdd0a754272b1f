#include "splat/scene_file.h"

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "splat/ply.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr int kVersion = 1;
constexpr size_t kMaxText = 256;
constexpr std::uintmax_t kMaxJson = 1 << 20;

std::filesystem::path sidecar_path(std::filesystem::path path) {
  if (path.extension() != ".ply") {
    throw Error("{}: a scene's file name ends in .ply", path.string());
  }
  return path.replace_extension(".json");
}

json to_json(const Vec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

/// Four rows of four numbers.
json to_json(const glm::dmat4& matrix) {
  json rows = json::array();
  for (int r = 0; r < 4; ++r) {
    rows.push_back({matrix[0][r], matrix[1][r], matrix[2][r], matrix[3][r]});
  }
  return rows;
}

/// Reads the values of one JSON object, with errors that say which key of which file is wrong.
class Reader {
 public:
  Reader(const json& object, std::string name) : object_(object), name_(std::move(name)) {
    if (!object_.is_object()) {
      throw Error("{}: a JSON object was expected; the file is corrupt", name_);
    }
  }

  Reader child(const char* key) const { return {at(key), name_ + "." + key}; }

  float number(const char* key) const { return finite(at(key), key); }

  template <int N>
  glm::vec<N, float> vector(const char* key) const {
    const json& values = at(key);
    if (!values.is_array() || values.size() != N) {
      fail(key);
    }
    glm::vec<N, float> result;
    for (int i = 0; i < N; ++i) {
      result[i] = finite(values[i], key);
    }
    return result;
  }

  glm::dmat4 matrix(const char* key) const {
    const json& rows = at(key);
    if (!rows.is_array() || rows.size() != 4) {
      fail(key);
    }
    glm::dmat4 result;
    for (int r = 0; r < 4; ++r) {
      if (!rows[r].is_array() || rows[r].size() != 4) {
        fail(key);
      }
      for (int c = 0; c < 4; ++c) {
        if (!rows[r][c].is_number()) {
          fail(key);
        }
        result[c][r] = rows[r][c].get<double>();
      }
    }
    return result;
  }

  std::string text(const char* key) const {
    const json& value = at(key);
    if (!value.is_string() || value.get_ref<const std::string&>().size() > kMaxText) {
      fail(key);
    }
    return value.get<std::string>();
  }

  [[noreturn]] void fail(const char* key) const {
    throw Error("{}: \"{}\" is missing or out of range", name_, key);
  }

 private:
  const json& at(const char* key) const {
    const auto found = object_.find(key);
    if (found == object_.end()) {
      fail(key);
    }
    return *found;
  }

  float finite(const json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<float>())) {
      fail(key);
    }
    return value.get<float>();
  }

  const json& object_;
  std::string name_;
};

}  // namespace

json json_number(float value) { return std::strtod(fmt::format("{}", value).c_str(), nullptr); }

json scene_to_json(const Scene& scene, const Similarity& world) {
  json result = {
      {"version", kVersion},
      {"world", {{"scene_to_ras_mm", to_json(world.matrix())}, {"mm_per_unit", world.scale}}},
      {"axis", to_json(scene.axis)},
      {"extent", {json_number(scene.extent.x), json_number(scene.extent.y)}},
      {"sphere",
       {{"center", to_json(scene.sphere.center)}, {"radius", json_number(scene.sphere.radius)}}},
      {"bounds", {{"min", to_json(scene.bounds.min)}, {"max", to_json(scene.bounds.max)}}},
      {"title", scene.title},
      {"preset", scene.preset},
      {"created", scene.created},
  };
  Scene checked;  // what is written can be read
  scene_from_json(result, "the scene to be written", checked);
  return result;
}

Similarity scene_from_json(const json& object, const std::string& name, Scene& scene) {
  const Reader reader(object, name);
  if (reader.number("version") != kVersion) {
    throw Error("{}: is of a version this program does not know; use a newer clipgs", name);
  }
  scene.axis = reader.vector<3>("axis");
  if (std::abs(glm::length(scene.axis) - 1) > 1e-3f) {
    reader.fail("axis");
  }
  scene.extent = reader.vector<2>("extent");
  if (scene.extent.x > scene.extent.y) {
    reader.fail("extent");
  }
  const Reader sphere = reader.child("sphere");
  scene.sphere.center = sphere.vector<3>("center");
  scene.sphere.radius = sphere.number("radius");
  if (scene.sphere.radius < 0) {
    sphere.fail("radius");
  }
  const Reader bounds = reader.child("bounds");
  scene.bounds.min = bounds.vector<3>("min");
  scene.bounds.max = bounds.vector<3>("max");
  scene.title = reader.text("title");
  scene.preset = reader.text("preset");
  scene.created = reader.text("created");
  const Reader world = reader.child("world");
  try {
    return Similarity::from_matrix(world.matrix("scene_to_ras_mm"));
  } catch (const Error&) {
    world.fail("scene_to_ras_mm");
  }
}

void write_scene(const std::filesystem::path& path, const Scene& scene) {
  const std::filesystem::path sidecar = sidecar_path(path);
  const Similarity world = scene_to_world();
  const json metadata = scene_to_json(scene, world);
  write_ply(path, transform(scene.gaussians, world.inverse()));
  write_text(sidecar, metadata.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

Scene read_scene(const std::filesystem::path& path) {
  const std::filesystem::path sidecar = sidecar_path(path);
  const Gaussians stored = read_ply(path);
  if (!std::filesystem::exists(sidecar)) {
    throw Error("{}: has no {} beside it, which says how the scene lies in the patient",
                path.string(), sidecar.filename().string());
  }
  const std::vector<std::uint8_t> text = read_file(sidecar, kMaxJson);
  const json metadata = json::parse(text.begin(), text.end(), nullptr, false);
  Scene scene;
  const Similarity world = scene_from_json(metadata, sidecar.string(), scene);
  scene.gaussians = transform(stored, world);
  return scene;
}

}  // namespace clipgs
