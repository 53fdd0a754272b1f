#include "cli/build_arguments.h"

#include <fmt/format.h>
#include <set>

#include "cli/label_options.h"
#include "cli/quality.h"
#include "cli/section_options.h"
#include "cli/volume_options.h"
#include "core/error.h"
#include "core/file.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

Quality chosen_quality(const BuildArguments& arguments) {
  Quality quality = find_quality(arguments.quality);
  const Overrides& o = arguments.overrides;
  quality.size = o.size > 0 ? o.size : quality.size;
  quality.train_frames = o.train_frames > 0 ? o.train_frames : quality.train_frames;
  quality.test_frames = o.test_frames > 0 ? o.test_frames : quality.test_frames;
  quality.budget = o.budget > 0 ? o.budget : quality.budget;
  quality.steps = o.steps > 0 ? o.steps : quality.steps;
  quality.sh_degree = o.sh_degree >= 0 ? o.sh_degree : quality.sh_degree;
  return quality;
}

/// "skin,skeleton": several presets. The name of a file may have commas in it.
std::vector<std::string> presets_of(const std::string& list) {
  if (fs::exists(list)) {
    return {list};
  }
  std::vector<std::string> presets = CLI::detail::split(list, ',');
  std::set<std::string> names;
  for (const std::string& preset : presets) {
    if (!names.insert(fs::path(preset).stem().string()).second || preset.empty()) {
      throw CLI::ValidationError(
          "--preset",
          fmt::format("\"{}\" names a preset twice, or none; write skin,skeleton", list));
    }
  }
  return presets;
}

/// Of several looks: NAME-PRESET.sog, and a work folder of its own.
BuildArguments build_of_look(const BuildArguments& arguments, const std::string& preset) {
  const std::string name = fs::path(preset).stem().string();
  const fs::path output(arguments.output);
  BuildArguments build = arguments;
  build.look.preset = preset;
  build.output = output.parent_path() / fmt::format("{}-{}.sog", output.stem().string(), name);
  if (!arguments.work.empty()) {
    build.work = fs::path(arguments.work) / name;
  }
  return build;
}

}  // namespace

void add_build_options(CLI::App& command, BuildArguments& arguments) {
  add_look_options(command, arguments.look);
  command.get_option("--preset")
      ->description(
          "Look: a preset's name, a JSON file, or auto; several with commas between them: a case "
          "of "
          "each, which the viewer shows as looks of one volume");
  add_label_options(command, arguments.look.labels, arguments.loading);
  command
      .add_option("--quality", arguments.quality,
                  "instant (seconds, nothing trained), draft, standard or high")
      ->capture_default_str();
  add_title_option(command, arguments.title,
                   "region of the body and look, e.g. \"Head, skin and bone\"");
  command.add_option("--seed", arguments.seed, "Seed of everything random")->capture_default_str();
  add_section_options(command, arguments.section);
  add_section_coding(command, arguments.section);
  add_volume_options(command, arguments.loading);
  arguments.loading.work = [&arguments](const VolumeSize& size) {
    return dataset_memory(size, arguments.section, !arguments.look.as_scanned);
  };
}

fs::path work_folder(const BuildArguments& arguments) {
  if (!arguments.work.empty()) {
    return arguments.work;
  }
  return fs::path(arguments.output).replace_extension(".clipgs-work");
}

BuildOptions build_options(const BuildArguments& arguments) {
  const Quality quality = chosen_quality(arguments);
  BuildOptions options;
  options.pictures = arguments.tests;
  options.pictures.size = quality.size;
  options.pictures.train_frames = quality.train_frames;
  options.pictures.test_frames = quality.test_frames;
  options.pictures.validation_frames = (quality.test_frames + 1) / 2;
  options.pictures.train_spp = quality.train_spp;
  options.pictures.seed = arguments.seed;
  options.pictures.denoise = arguments.denoise;
  options.pictures.upsample = !arguments.look.as_scanned;
  options.section = arguments.section;
  options.training.budget = options.training.start = quality.budget;
  options.training.steps = quality.steps;
  options.training.sh_degree = quality.sh_degree;
  options.training.seed = arguments.seed;
  options.papers_way = arguments.model == "clipgs";
  options.title = arguments.title;
  return options;
}

void require_volume(const BuildArguments& arguments) {
  if (!fs::exists(arguments.volume)) {
    throw Error(
        "{}: does not exist; give a DICOM folder or .zip, or a NIfTI, NRRD or MetaImage file",
        arguments.volume);
  }
}

std::vector<BuildArguments> builds_of_looks(const BuildArguments& arguments) {
  const std::vector<std::string> presets = presets_of(arguments.look.preset);
  if (presets.size() == 1) {
    return {arguments};
  }
  std::vector<BuildArguments> builds;
  builds.reserve(presets.size());
  for (const std::string& preset : presets) {
    builds.push_back(build_of_look(arguments, preset));
  }
  return builds;
}

void require_looks(const std::vector<BuildArguments>& builds) {
  require_volume(builds.front());
  const Volume volume = load_volume(builds.front().volume, builds.front().loading);
  for (const BuildArguments& build : builds) {
    require_writable(build.output);
    require_look_for_section(load_look(build.look, volume), build.section);
  }
}

}  // namespace clipgs
