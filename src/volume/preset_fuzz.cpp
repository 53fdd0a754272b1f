// libFuzzer's entry to JSON that people write: presets, light rigs and tables of labels, told apart
// by the first byte.
#include "core/fuzz.h"
#include "volume/built_in_files.h"
#include "volume/phantom.h"
#include "volume/preset.h"

namespace clipgs::fuzz {

std::vector<Bytes> seeds() {
  std::vector<Bytes> result;
  for (const BuiltInFile& file : built_in_presets()) {
    result.push_back(bytes_of("p" + std::string(file.json)));
  }
  for (const BuiltInFile& file : built_in_rigs()) {
    result.push_back(bytes_of("r" + std::string(file.json)));
  }
  result.push_back(
      bytes_of(R"(l{"labels": [{"label": 5, "name": "liver", "color": "#a04030", "opacity": 0.5},)"
               R"( {"label": 7, "visible": false}]})"));
  return result;
}

void read(std::span<const std::uint8_t> input) {
  static const Volume kVolume = make_ball(8, 3, 300, -1000);
  if (input.empty()) {
    return;
  }
  const std::span<const std::uint8_t> text = input.subspan(1);
  if (input[0] == 'r') {
    load_rig(as_file(text, "input.json").string());
  } else if (input[0] == 'l') {
    load_label_table(as_file(text, "input.json"));
  } else {
    Preset preset = parse_preset(text_of(text), "input", "input.json");
    resolve_percentiles(preset, kVolume);
  }
}

}  // namespace clipgs::fuzz
