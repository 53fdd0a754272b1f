#include "splat/scene_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "core/utf8.h"
#include "splat/ply.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr int kVersion = 1;
constexpr std::uintmax_t kMaxJson = std::uintmax_t{16} << 20;
constexpr const char* kTitleKey = "title";
// Beside its beginning, which is all that readers of before there were long ones take.
constexpr const char* kWholeTitleKey = "whole_title";
constexpr const char* kLayerColumn = "layer";
constexpr const char* kSplatsKey = "splats";
constexpr const char* kPlaced = "placed";
constexpr const char* kTrainedKey = "trained";

std::filesystem::path sidecar_path(std::filesystem::path path) {
  if (path.extension() != ".ply") {
    throw Error("{}: a scene's file name ends in .ply", path.string());
  }
  return path.replace_extension(".json");
}

/// Four rows of four numbers.
json to_json(const glm::dmat4& matrix) {
  json rows = json::array();
  for (int r = 0; r < 4; ++r) {
    rows.push_back({matrix[0][r], matrix[1][r], matrix[2][r], matrix[3][r]});
  }
  return rows;
}

json to_json(const PlaneStates& states) {
  return {{"count", states.count},
          {"first", json_number(states.first)},
          {"spacing", json_number(states.spacing)},
          {"keeps", states.keeps_below ? "below" : "above"}};
}

/// Of sixteen times three numbers, none large enough to overflow a renderer.
FaceGain gain_from_json(const json& list, const JsonReader& reader) {
  constexpr float kLargest = 10;
  FaceGain gain;
  if (!list.is_array() || list.size() != gain.coefficients.size()) {
    reader.fail("face_gain");
  }
  for (size_t k = 0; k < list.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const json& value =
          list[k].is_array() && list[k].size() == 3 ? list[k][static_cast<size_t>(c)] : json();
      if (!value.is_number() || !(std::abs(value.get<double>()) <= kLargest)) {
        reader.fail("face_gain");
      }
      gain.coefficients[k][c] = value.get<float>();
    }
  }
  return gain;
}

PlaneStates states_from_json(const JsonReader& reader) {
  PlaneStates states;
  states.count = reader.integer("count", 1, kMaxStates);
  states.first = reader.number("first");
  states.spacing = reader.number("spacing");
  if (!(states.spacing > 0)) {
    reader.fail("spacing");
  }
  const std::string keeps = reader.text("keeps");
  if (keeps != "below" && keeps != "above") {
    reader.fail("keeps");
  }
  states.keeps_below = keeps == "below";
  return states;
}

std::vector<std::uint16_t> layers_from_column(const std::vector<float>& column,
                                              const PlaneStates& states, const std::string& name) {
  std::vector<std::uint16_t> layers(column.size());
  for (size_t i = 0; i < column.size(); ++i) {
    if (!(column[i] >= 0 && column[i] < static_cast<float>(states.count))) {
      throw Error("{}: layer of splat {} is {}, but the scene has {} states; the file is corrupt",
                  name, i, column[i], states.count);
    }
    layers[i] = static_cast<std::uint16_t>(column[i]);
  }
  return layers;
}

}  // namespace

json scene_to_json(const Scene& scene, const Similarity& world) {
  json result = {
      {"version", kVersion},
      {"world", {{"scene_to_ras_mm", to_json(world.matrix())}, {"mm_per_unit", world.scale}}},
      {"axis", json_vector(scene.axis)},
      {"extent", {json_number(scene.extent.x), json_number(scene.extent.y)}},
      {"sphere",
       {{"center", json_vector(scene.sphere.center)},
        {"radius", json_number(scene.sphere.radius)}}},
      {"bounds", {{"min", json_vector(scene.bounds.min)}, {"max", json_vector(scene.bounds.max)}}},
      {kTitleKey, utf8_beginning(scene.title, JsonReader::kMostText)},
      {"preset", scene.preset},
      {"created", scene.created},
  };
  if (scene.title.size() > JsonReader::kMostText) {
    result[kWholeTitleKey] = scene.title;
  }
  if (const json look = volume_look_json(scene.look); !look.is_null()) {
    result[kLookKey] = look;
  }
  if (!scene.face_gain.none()) {
    result["face_gain"] = json::array();
    for (const Vec3& coefficient : scene.face_gain.coefficients) {
      result["face_gain"].push_back(json_vector(coefficient));
    }
  }
  if (scene.placed) {
    result[kSplatsKey] = kPlaced;
  }
  if (scene.trained < 1) {
    result[kTrainedKey] = json_number(scene.trained);
  }
  if (scene.states.count > 0) {
    result["states"] = to_json(scene.states);
  }
  Scene checked;  // what is written can be read
  scene_from_json(result, "the scene to be written", checked);
  return result;
}

Similarity scene_from_json(const json& object, const std::string& name, Scene& scene) {
  const JsonReader reader(object, name);
  if (reader.number("version") != kVersion) {
    throw Error("{}: is of a version this program does not know; use a newer clipgs", name);
  }
  scene.axis = reader.unit_vector("axis");
  scene.extent = reader.vector<2>("extent");
  if (scene.extent.x > scene.extent.y) {
    reader.fail("extent");
  }
  const JsonReader sphere = reader.child("sphere");
  scene.sphere.center = sphere.vector<3>("center");
  scene.sphere.radius = sphere.number("radius");
  if (scene.sphere.radius < 0) {
    sphere.fail("radius");
  }
  const JsonReader bounds = reader.child("bounds");
  scene.bounds.min = bounds.vector<3>("min");
  scene.bounds.max = bounds.vector<3>("max");
  scene.title =
      reader.has(kWholeTitleKey) ? reader.text(kWholeTitleKey, kMostTitle) : reader.text(kTitleKey);
  scene.preset = reader.text("preset");
  scene.created = reader.text("created");
  scene.look = read_volume_look(reader);
  if (const auto gain = object.find("face_gain"); gain != object.end()) {
    scene.face_gain = gain_from_json(*gain, reader);
  }
  scene.placed = object.contains(kSplatsKey);
  if (scene.placed && reader.text(kSplatsKey) != kPlaced) {
    reader.fail(kSplatsKey);
  }
  scene.trained = object.contains(kTrainedKey) ? reader.number(kTrainedKey) : 1;
  if (scene.trained < 0 || scene.trained > 1) {
    reader.fail(kTrainedKey);
  }
  scene.states =
      object.contains("states") ? states_from_json(reader.child("states")) : PlaneStates();
  const JsonReader world = reader.child("world");
  try {
    return Similarity::from_matrix(world.matrix("scene_to_ras_mm"));
  } catch (const Error&) {
    world.fail("scene_to_ras_mm");
  }
}

void write_scene(const std::filesystem::path& path, const Scene& scene, const SceneExtras& extras) {
  const std::filesystem::path sidecar = sidecar_path(path);
  const Similarity world = scene_to_world();
  json metadata = scene_to_json(scene, world);
  metadata.update(extras.keys);
  PlyColumns columns = extras.columns;
  if (!scene.layers.empty()) {
    columns[kLayerColumn].assign(scene.layers.begin(), scene.layers.end());
  }
  write_ply(path, transform(scene.gaussians, world.inverse()), columns);
  write_text(sidecar, metadata.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

Scene read_scene(const std::filesystem::path& path, SceneExtras* extras) {
  const std::filesystem::path sidecar = sidecar_path(path);
  PlyColumns columns = extras != nullptr ? extras->columns : PlyColumns();
  columns[kLayerColumn];
  const Gaussians stored = read_ply(path, &columns);
  if (!std::filesystem::exists(sidecar)) {
    throw Error("{}: has no {} beside it, which says how the scene lies in the patient",
                path.string(), sidecar.filename().string());
  }
  const std::vector<std::uint8_t> text = read_file(sidecar, kMaxJson);
  json metadata = json::parse(text.begin(), text.end(), nullptr, false);
  Scene scene;
  const Similarity world = scene_from_json(metadata, sidecar.string(), scene);
  scene.gaussians = transform(stored, world);
  scene.layers = layers_from_column(columns[kLayerColumn], scene.states, path.string());
  if (extras != nullptr) {
    columns.erase(kLayerColumn);
    extras->columns = std::move(columns);
    extras->keys = std::move(metadata);
  }
  return scene;
}

}  // namespace clipgs
