#include <nlohmann/json.hpp>

#include "cli/info_kinds.h"
#include "core/json_reader.h"
#include "train/model_file.h"

namespace clipgs {

using Json = nlohmann::ordered_json;

Json describe_model(const std::filesystem::path& path) {
  const UniaxialModel model = read_model(path);
  const UniaxialParameters& parameters = model.parameters;
  Json json;
  json["kind"] = "model";
  json["splats"] = model.scene.gaussians.size();
  json["sh_bands"] = model.scene.gaussians.sh_degree();
  json["bytes"] = std::filesystem::file_size(path);
  json["normal"] = json_vector(parameters.normal);
  json["truncation"] = truncation_name(parameters.truncation);
  json["thresholds"] = parameters.thresholds.size();
  json["temperature_mm"] = json_number(parameters.temperature);
  if (parameters.adjustment) {
    const AdjustmentOptions& options = parameters.adjustment->options();
    json["adjustment"] = {{"weights", parameters.adjustment->weights().size()},
                          {"width", options.width},
                          {"hidden_layers", options.hidden_layers},
                          {"window", json_number(options.window)}};
  }
  describe_common(model.scene, !model.scene.layers.empty(), json);
  return json;
}

}  // namespace clipgs
