#include "train/model_file.h"

#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "splat/scene_file.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr const char* kModelKey = "model";
constexpr const char* kThresholdColumn = "threshold";
constexpr int kModelVersion = 1;

json to_json(const Adjustment& adjustment) {
  const AdjustmentOptions& options = adjustment.options();
  json weights = json::array();
  for (const float weight : adjustment.weights()) {
    weights.push_back(json_number(weight));
  }
  return {{"position_octaves", options.position_octaves},
          {"plane_octaves", options.plane_octaves},
          {"width", options.width},
          {"hidden_layers", options.hidden_layers},
          {"window", json_number(options.window)},
          {"shape", options.shape},
          {"weights", std::move(weights)}};
}

Adjustment adjustment_from_json(const JsonReader& reader, const Scene& scene) {
  AdjustmentOptions options;
  options.position_octaves = reader.integer("position_octaves", 0, 16);
  options.plane_octaves = reader.integer("plane_octaves", 0, 16);
  options.width = reader.integer("width", 16, 1024);
  options.hidden_layers = reader.integer("hidden_layers", 1, 16);
  options.window = reader.number("window");
  options.shape = reader.boolean("shape");
  if (options.width % 16 != 0) {
    reader.fail("width");
  }
  Adjustment adjustment(options, scene.sphere, scene.extent.y - scene.extent.x, 0);
  adjustment.weights() = reader.numbers("weights", adjustment.weights().size());
  return adjustment;
}

}  // namespace

void write_model(const std::filesystem::path& path, const UniaxialModel& model) {
  const UniaxialParameters& parameters = model.parameters;
  SceneExtras extras;
  extras.columns[kThresholdColumn] = parameters.thresholds;
  json block = {{"version", kModelVersion},
                {"normal", json_vector(parameters.normal)},
                {"truncation", truncation_name(parameters.truncation)},
                {"temperature", json_number(parameters.temperature)}};
  if (parameters.adjustment) {
    block["adjustment"] = to_json(*parameters.adjustment);
  }
  extras.keys[kModelKey] = std::move(block);
  write_scene(path, model.scene, extras);
}

bool is_model(const std::filesystem::path& path) {
  const std::filesystem::path sidecar = std::filesystem::path(path).replace_extension(".json");
  if (path.extension() != ".ply" || !std::filesystem::exists(sidecar)) {
    return false;
  }
  const json keys = json::parse(read_text(sidecar), nullptr, false);
  return keys.is_object() && keys.contains(kModelKey);
}

UniaxialModel read_model(const std::filesystem::path& path) {
  SceneExtras extras;
  extras.columns[kThresholdColumn];
  UniaxialModel model;
  model.scene = read_scene(path, &extras);
  const std::string name = path.string();
  if (!extras.keys.contains(kModelKey)) {
    throw Error("{}: is a scene, not a model; make one with clipgs train --model clipgs", name);
  }
  const JsonReader reader(extras.keys[kModelKey], name + ": model");
  if (reader.number("version") != kModelVersion) {
    throw Error(
        "{}: is a model of another version of clipgs; make it anew with clipgs train --model "
        "clipgs",
        name);
  }
  UniaxialParameters& parameters = model.parameters;
  parameters.normal = reader.unit_vector("normal");
  try {
    parameters.truncation = parse_truncation(reader.text("truncation"));
  } catch (const Error&) {
    reader.fail("truncation");
  }
  parameters.temperature = reader.number("temperature");
  if (!(parameters.temperature > 0)) {
    reader.fail("temperature");
  }
  parameters.thresholds = std::move(extras.columns[kThresholdColumn]);
  if (parameters.thresholds.size() != model.scene.gaussians.size()) {
    throw Error("{}: has no property \"threshold\"; the file is no model or corrupt", name);
  }
  if (extras.keys[kModelKey].contains("adjustment")) {
    parameters.adjustment = adjustment_from_json(reader.child("adjustment"), model.scene);
  }
  return model;
}

}  // namespace clipgs
