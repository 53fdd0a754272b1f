#include "bake/planes_file.h"

#include <algorithm>
#include <cmath>

#include "bake/states.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "splat/scene_file.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr std::uintmax_t kMaxJson = std::uintmax_t{64} << 20;
constexpr double kSpacingTolerance = 0.01;  // share of the spacing
constexpr float kNormalTolerance = 1e-4f;

struct StatePlane {
  std::string file;
  Vec3 normal;  // unit
  float offset = 0;
};

std::vector<StatePlane> read_list(const JsonReader& reader, const std::string& name) {
  std::vector<StatePlane> result;
  for (const JsonReader& entry : reader.children("states", kMaxStates)) {
    const std::vector<float> plane = entry.numbers("plane", 4);
    StatePlane state{entry.text("file"), {plane[0], plane[1], plane[2]}, plane[3]};
    const float length = glm::length(state.normal);
    if (state.file.empty()) {
      entry.fail("file");
    }
    if (!(std::abs(length - 1) < kNormalTolerance)) {
      entry.fail("plane");
    }
    state.normal /= length;
    state.offset /= length;
    result.push_back(std::move(state));
  }
  if (result.size() < kMinStates) {
    throw Error("{}: lists {} states; at least {} make a scene", name, result.size(), kMinStates);
  }
  return result;
}

void require_parallel(const std::vector<StatePlane>& list, const std::string& name) {
  const Vec3& normal = list.front().normal;
  for (const StatePlane& state : list) {
    if (glm::length(state.normal + normal) < kNormalTolerance) {
      throw Error(
          "{}: the plane of {} keeps the other side than that of {}; all must keep one side", name,
          state.file, list.front().file);
    }
    if (!(glm::length(state.normal - normal) < kNormalTolerance)) {
      throw Error("{}: the plane of {} is not parallel to that of {}; all must have one normal",
                  name, state.file, list.front().file);
    }
  }
}

/// The even step between the planes along their normal, mm; negative if they run against it.
double require_even_steps(const std::vector<StatePlane>& list, const std::string& name) {
  const double whole = static_cast<double>(list.back().offset) - list.front().offset;
  const double step = whole / static_cast<double>(list.size() - 1);
  for (size_t k = 1; k < list.size(); ++k) {
    const double here = static_cast<double>(list[k].offset) - list[k - 1].offset;
    if (!(here * step > 0)) {
      throw Error("{}: {} is out of order; list the states as their planes lie along the normal",
                  name, list[k].file);
    }
  }
  for (size_t k = 1; k < list.size(); ++k) {
    const double here = static_cast<double>(list[k].offset) - list[k - 1].offset;
    if (!(std::abs(here - step) <= kSpacingTolerance * std::abs(step))) {
      throw Error(
          "{}: the plane of {} is {:.4g} mm from the one before it, the mean is {:.4g}; states "
          "must "
          "be evenly spaced, within 1 %",
          name, list[k].file, std::abs(here), std::abs(step));
    }
  }
  return step;
}

/// Sets scene.axis, if the file has none, and scene.states; `list` comes out in the states' order,
/// ascending along the axis.
void set_states(std::vector<StatePlane>& list, bool has_axis, const std::string& name,
                Scene& scene) {
  require_parallel(list, name);
  const double step = require_even_steps(list, name);
  const Vec3 normal = list.front().normal;
  if (!has_axis) {
    scene.axis = step > 0 ? normal : -normal;
  }
  const float side = glm::dot(normal, scene.axis) > 0 ? 1.0f : -1.0f;
  if (!(glm::length(side * normal - scene.axis) < kNormalTolerance)) {
    throw Error("{}: the planes lie not across its \"axis\"; correct one of them", name);
  }
  if (static_cast<double>(side) * step < 0) {
    std::ranges::reverse(list);
  }
  scene.states.count = static_cast<int>(list.size());
  scene.states.first = side * list.front().offset;
  scene.states.spacing = static_cast<float>(std::abs(step));
  scene.states.keeps_below = side < 0;
}

/// Keys of a scene that planes.json may leave out, as they are then.
json scene_defaults() {
  json result = scene_to_json(Scene(), scene_to_world());
  result.erase("version");
  return result;
}

}  // namespace

PlanesFile read_planes(const std::filesystem::path& path) {
  const std::string name = path.string();
  const std::vector<std::uint8_t> text = read_file(path, kMaxJson);
  json object = json::parse(text.begin(), text.end(), nullptr, false);
  std::vector<StatePlane> list = read_list(JsonReader(object, name), name);

  PlanesFile result;
  result.has_sphere = object.contains("sphere");
  result.has_bounds = object.contains("bounds");
  result.has_extent = object.contains("extent");
  const bool has_axis = object.contains("axis");
  if (object.contains("uncut")) {
    result.uncut = JsonReader(object, name).text("uncut");
  }
  object.erase("states");  // which scenes have another kind of
  const json defaults = scene_defaults();
  for (const auto& [key, value] : defaults.items()) {
    if (!object.contains(key)) {
      object[key] = value;
    }
  }
  result.world = scene_from_json(object, name, result.scene);
  set_states(list, has_axis, name, result.scene);
  for (StatePlane& state : list) {
    result.files.push_back(std::move(state.file));
  }
  return result;
}

json planes_to_json(const PlanesFile& planes) {
  const Scene& scene = planes.scene;
  json result = scene_to_json(scene, planes.world);
  json& list = result["states"] = json::array();
  for (int k = 0; k < scene.states.count; ++k) {
    const Plane plane = scene.states.plane(scene.axis, scene.states.position(k));
    const Vec3& n = plane.normal;
    list.push_back(
        {{"file", planes.files[static_cast<size_t>(k)]},
         {"plane",
          {json_number(n.x), json_number(n.y), json_number(n.z), json_number(plane.offset)}}});
  }
  result["uncut"] = planes.uncut;
  return result;
}

}  // namespace clipgs
