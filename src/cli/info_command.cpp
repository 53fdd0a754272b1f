#include <algorithm>
#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "asset/privacy.h"
#include "cli/archive_volume.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/head_picture.h"
#include "cli/histogram_picture.h"
#include "cli/info_kinds.h"
#include "cli/sheet.h"
#include "cli/volume_options.h"
#include "core/error.h"
#include "core/file.h"
#include "train/model_file.h"
#include "volume/identify.h"
#include "volume/load.h"
#include "volume/preset.h"
#include "volume/steepness_histogram.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct InfoOptions {
  fs::path path;
  ArchiveArguments archive;  ///< where the path is an address
  LoadOptions load;
  bool json = false;
  bool privacy = false;
  std::string histogram;  ///< file to draw it to; empty: none
  std::string preset;     ///< whose colours it has
  std::string heads;      ///< file to draw the head to, before and after --deface; empty: none
};

Json list_of(const Vec3& v) { return {v.x, v.y, v.z}; }

/// `choice` is what --series takes.
Json describe_series(const std::vector<SeriesInfo>& choices) {
  Json list = Json::array();
  for (const SeriesInfo& series : choices) {
    Json entry = {{"choice", list.size() + 1},
                  {"uid", series.uid},
                  {"modality", series.modality},
                  {"number", series.number},
                  {"dims", {series.dims.x, series.dims.y, series.dims.z}},
                  {"taken", series.taken}};
    if (!series.phase.empty()) {
      entry["phase"] = series.phase;
    }
    list.push_back(std::move(entry));
  }
  return list;
}

Json describe_preparation(const std::vector<PreparationStep>& steps) {
  Json list = Json::array();
  for (const PreparationStep& step : steps) {
    Json entry = {{"step", step.name}};
    for (const auto& [figure, value] : step.figures) {
      entry[figure] = value;
    }
    list.push_back(std::move(entry));
  }
  return list;
}

void write_histogram(const Volume& volume, const InfoOptions& options) {
  const Preset preset = load_preset(options.preset, volume);
  const Vec2 values = histogram_values(preset);
  const std::string unit = volume.modality == Modality::kCt ? "HU" : "";
  write_sheet(options.histogram,
              draw_histogram(steepness_histogram(volume, values.x, values.y, options.path.string()),
                             preset, unit));
}

/// Loads it, and draws its head on the way if that is asked for.
LoadedVolume load_and_draw(const InfoOptions& options) {
  if (options.heads.empty()) {
    return load_with_series(options.path, options.load);
  }
  Box box;
  std::vector<Image> pictures;
  LoadOptions load = options.load;
  load.watch_deface = [&](const Volume& volume) {
    box = pictures.empty() ? box_of_head(volume) : box;
    pictures.push_back(draw_head(volume, box));
  };
  LoadedVolume loaded = load_with_series(options.path, load);
  write_sheet(options.heads, draw_before_and_after(pictures.front(), pictures.back()));
  return loaded;
}

Json describe_volume(const InfoOptions& options) {
  const LoadedVolume loaded = load_and_draw(options);
  const Volume& volume = loaded.volume;
  if (!options.histogram.empty()) {
    write_histogram(volume, options);
  }
  const auto [low, high] = volume.values.range();
  Json json;
  json["kind"] = "volume";
  json["dims"] = {volume.dims.x, volume.dims.y, volume.dims.z};
  json["spacing_mm"] = list_of(volume.spacing);
  json["size_mm"] = list_of(Vec3(volume.dims) * volume.spacing);
  json["origin_ras_mm"] = list_of(volume.origin);
  json["axes_ras"] = {list_of(volume.direction[0]), list_of(volume.direction[1]),
                      list_of(volume.direction[2])};
  json["modality"] = modality_name(volume.modality);
  if (volume.part != BodyPart::kUnknown) {
    json["region"] = body_part_name(volume.part);
  }
  json["values"] = {low, high};
  const Identity identity = identify(volume);
  json["looks_like"] = identity.what;
  json["because"] = identity.reason;
  json["auto_preset"] = identity.preset;
  for (const SuggestedWindow& window : identity.windows) {
    json["windows"].push_back(
        {{"name", window.name}, {"center", window.window.center}, {"width", window.window.width}});
  }
  if (!identity.doubt.empty()) {
    json["doubt"] = identity.doubt;
  }
  if (!loaded.prepared.empty()) {
    json["prepared"] = describe_preparation(loaded.prepared);
  }
  if (!options.histogram.empty()) {
    json["histogram"] = options.histogram;
  }
  if (!options.heads.empty()) {
    json["deface_picture"] = options.heads;
  }
  if (!loaded.series.empty()) {
    json["series"] = describe_series(loaded.series);
  }
  return json;
}

/// One kind of thing that `info` knows; the first that matches a path describes it. A model is a
/// scene as well.
struct InfoKind {
  bool (*matches)(const fs::path& path);
  Json (*describe)(const InfoOptions& options);
};

bool is_volume(const fs::path& /*path*/) {
  return true;
}  // the last: load_volume says what is wrong

Json describe_case_at(const InfoOptions& options) { return describe_case(options.path); }
Json describe_model_at(const InfoOptions& options) { return describe_model(options.path); }
Json describe_scene_at(const InfoOptions& options) { return describe_scene(options.path); }
Json describe_dataset_at(const InfoOptions& options) { return describe_dataset(options.path); }

constexpr std::array kKinds{
    InfoKind{is_case, describe_case_at}, InfoKind{is_dataset, describe_dataset_at},
    InfoKind{is_model, describe_model_at}, InfoKind{is_scene, describe_scene_at},
    InfoKind{is_volume, describe_volume}};

std::string as_text(const Json& value) {
  if (value.is_string()) {
    return value.get<std::string>();
  }
  if (value.is_number_float()) {
    return fmt::format("{:.6g}", value.get<double>());
  }
  if (value.is_array() || value.is_object()) {
    std::vector<std::string> parts;
    for (const auto& [key, item] : value.items()) {
      parts.push_back(value.is_object() ? key + " " + as_text(item) : as_text(item));
    }
    const bool nested = value.is_array() && !value.empty() && value[0].is_structured();
    return fmt::format("{}", fmt::join(parts, nested ? "; " : ", "));
  }
  return value.dump();
}

/// All that a case says of its origin.
void run_privacy(const InfoOptions& options) {
  if (!is_case(options.path)) {
    throw Error("{}: is no case (.sog), and --privacy tells what one says of its origin",
                options.path.string());
  }
  const std::vector<PrivacyNote> notes = privacy_notes(options.path);
  if (options.json) {
    Json list = Json::array();
    for (const PrivacyNote& note : notes) {
      list.push_back({{"where", note.where},
                      {"value", note.value},
                      {"what", note.what},
                      {"foreign", note.foreign}});
    }
    fmt::print("{}\n", Json{{"kind", "privacy"}, {"notes", list}}.dump(2));
    return;
  }
  fmt::print("{} says of its origin\n", options.path.string());
  for (const PrivacyNote& note : notes) {
    fmt::print("{} {:<22} {}\n", note.foreign ? "!" : " ", note.where,
               note.value.empty() ? note.what : fmt::format("{} ({})", note.value, note.what));
  }
}

void run_info(InfoOptions options) {
  const GivenVolume given(options.path.string(), options.load, options.archive);
  const std::string name = options.path.string();
  options.path = given.path();
  if (options.privacy) {
    run_privacy(options);
    return;
  }
  const auto* const kind =
      std::ranges::find_if(kKinds, [&](const InfoKind& k) { return k.matches(options.path); });
  for (const auto& [file, option] : {std::pair(options.histogram, "--histogram"),
                                     std::pair(options.heads, "--deface-picture")}) {
    if (file.empty()) {
      continue;
    }
    if (kind != &kKinds.back()) {
      throw Error("{}: no volume; {} draws one", options.path.string(), option);
    }
    require_writable(file);
  }
  const Json json = kind->describe(options);
  if (options.json) {
    fmt::print("{}\n", json.dump(2));
    return;
  }
  fmt::print("{}\n", name);
  for (const auto& [key, value] : json.items()) {
    if (value.is_array() && !value.empty() && value[0].is_object()) {
      for (const Json& item : value) {
        fmt::print("  {:<14} {}\n", key, as_text(item));
      }
    } else {
      fmt::print("  {:<14} {}\n", key, as_text(value));
    }
  }
}

}  // namespace

void add_info_command(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand("info", "Say what a file or folder is");
  command->footer(
      "Example: clipgs info ct-folder/ --json\n"
      "         clipgs info case.sog --privacy\n"
      "         clipgs info signal.nrrd --modality mr\n"
      "         clipgs info ct.nii.gz --histogram values.png --preset anatomy\n"
      "         clipgs info head.nii.gz --deface --deface-picture heads.png");
  command
      ->add_option(
          "FILE", options->path,
          "Volume (DICOM folder, file or .zip, NIfTI, NRRD, MetaImage, or an address in an "
          "archive, as clipgs fetch has it), dataset folder, case (.sog), scene or model "
          "(.ply)")
      ->required();
  command->add_flag("--json", options->json, "Print JSON");
  command->add_flag("--privacy", options->privacy,
                    "Say all that a case tells of its origin, and what in it no clipgs writes");
  CLI::Option* const histogram =
      command
          ->add_option("--histogram", options->histogram,
                       "Draw how often values occur with which gradient, over a preset's colours "
                       "(.png or .webp)")
          ->check(ends_in({".png", ".webp"}));
  options->preset = "auto";
  command
      ->add_option("--preset", options->preset,
                   "Whose colours and values the histogram has: a preset's name or .json file")
      ->needs(histogram)
      ->capture_default_str();
  add_volume_options(*command, options->load);
  add_archive_options(*command, options->archive);
  command
      ->add_option("--deface-picture", options->heads,
                   "Draw the head from the front and from its right, before and after --deface "
                   "(.png or .webp)")
      ->check(ends_in({".png", ".webp"}))
      ->needs("--deface");
  options->load.warn_of_size = true;
  command->callback([options] { run_info(*options); });
}

}  // namespace clipgs
