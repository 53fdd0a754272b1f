#include <nlohmann/json.hpp>

#include "asset/case.h"
#include "cli/info_kinds.h"
#include "core/json_reader.h"
#include "splat/overdraw.h"
#include "splat/scene_file.h"

namespace clipgs {

namespace {

using Json = nlohmann::ordered_json;

Json rounded_list(const Vec3& v) { return {json_number(v.x), json_number(v.y), json_number(v.z)}; }

}  // namespace

void describe_common(const Scene& scene, bool has_layers, Json& json) {
  json["title"] = scene.title;
  if (scene.look.part != BodyPart::kUnknown) {
    json["region"] = body_part_name(scene.look.part);
  }
  json["preset"] = scene.preset;
  if (const nlohmann::json look = volume_look_json(scene.look); !look.is_null()) {
    json[kLookKey] = look;
  }
  json["created"] = scene.created;
  json["trained"] = json_number(scene.trained);
  json["axis"] = rounded_list(scene.axis);
  json["extent_mm"] = {json_number(scene.extent.x), json_number(scene.extent.y)};
  json["center_ras_mm"] = rounded_list(scene.sphere.center);
  json["radius_mm"] = json_number(scene.sphere.radius);
  json["bounds_ras_mm"] = {rounded_list(scene.bounds.min), rounded_list(scene.bounds.max)};
  if (scene.states.count > 0) {
    json["states"] = {{"count", scene.states.count},
                      {"first_mm", json_number(scene.states.first)},
                      {"spacing_mm", json_number(scene.states.spacing)},
                      {"keeps", scene.states.keeps_below ? "below" : "above"},
                      {"layers", has_layers}};
  }
}

bool is_case(const std::filesystem::path& path) { return path.extension() == ".sog"; }

Json describe_case(const std::filesystem::path& path) {
  const CaseInfo info = read_case_info(path);
  Json json;
  json["kind"] = "case";
  json["splats"] = info.splats;
  json["sh_bands"] = info.sh_degree;
  json["face_colors"] = info.has_face_colors;
  json["bytes"] = info.bytes;
  if (!info.section_problem.empty()) {
    json["section"] = "broken: " + info.section_problem;
  }
  if (info.section) {
    const IVec3& dims = info.section->dims;
    json["section"] = {{"dims", {dims.x, dims.y, dims.z}},
                       {"bytes", info.section->bytes},
                       {"tone", tone_name(info.section->tone)}};
  }
  json["thumbnail"] = !info.thumbnail.empty();
  json["generator"] = info.generator;
  describe_common(info.scene, info.has_layers, json);
  return json;
}

bool is_scene(const std::filesystem::path& path) { return path.extension() == ".ply"; }

Json describe_scene(const std::filesystem::path& path) {
  const Scene scene = read_scene(path);
  Json json;
  json["kind"] = "scene";
  json["splats"] = scene.gaussians.size();
  json["sh_bands"] = scene.gaussians.sh_degree();
  json["face_colors"] = scene.gaussians.has_face_colors();
  json["bytes"] = std::filesystem::file_size(path);
  json["fragments_a_pixel"] = json_number(overdraw(scene.gaussians, scene.sphere.radius));
  describe_common(scene, !scene.layers.empty(), json);
  return json;
}

}  // namespace clipgs
