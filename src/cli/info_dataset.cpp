#include <nlohmann/json.hpp>

#include "cinema/dataset.h"
#include "cli/info_kinds.h"

namespace clipgs {

bool is_dataset(const std::filesystem::path& path) {
  return std::filesystem::exists(path / "transforms.json");
}

nlohmann::ordered_json describe_dataset(const std::filesystem::path& path) {
  const Dataset dataset = load_dataset(path);
  nlohmann::ordered_json json = {
      {"kind", "dataset"}, {"preset", dataset.preset}, {"tone", tone_name(dataset.tone)}};
  for (const Split split : kSplits) {
    const std::vector<const Frame*> frames = dataset.split(split);
    double noise = 0;
    double masked = 0;
    for (const Frame* frame : frames) {
      noise += frame->noise_db / static_cast<double>(frames.size());
      masked += frame->masked_noise_db / static_cast<double>(frames.size());
    }
    json[split_name(split)] = {
        {"pictures", frames.size()}, {"noise_db", noise}, {"masked_noise_db", masked}};
  }
  if (!dataset.frames.empty()) {
    const Camera& camera = dataset.frames.front().camera;
    json["size"] = {camera.width, camera.height};
  }
  json["extent_mm"] = {dataset.extent.x, dataset.extent.y};
  return json;
}

}  // namespace clipgs
