#include <array>
#include <fmt/format.h>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pipeline/build_case.h"
#include "pipeline/instant_case.h"
#include "pipeline/section_step.h"

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/look_options.h"
#include "cli/section_options.h"
#include "cli/test_picture_options.h"
#include "cli/volume_options.h"
#include "core/error.h"
#include "core/file.h"
#include "volume/load.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

/// How much work a build puts in.
struct Quality {
  const char* name;
  int size;  // px, training and test pictures
  int train_frames;
  int test_frames;  // per test split; half as many per validation split
  int train_spp;
  size_t budget;
  size_t steps;
  int sh_degree;
};

// Many pictures of few samples teach more than few clean ones: every picture shows other planes,
// and noise averages out over them. What limits their number is the memory that training holds them
// in.
constexpr std::array kQualities = {
    Quality{"draft", 192, 600, 8, 4, 40000, 4000, 1},
    Quality{"standard", 256, 2000, 20, 10, 60000, 8000, 2},
    Quality{"high", 512, 3000, 32, 12, 150000, 24000, 2},
};

constexpr const char* kInstant = "instant";

const Quality& find_quality(const std::string& name) {
  for (const Quality& quality : kQualities) {
    if (name == quality.name) {
      return quality;
    }
  }
  throw CLI::ValidationError("--quality",
                             fmt::format("\"{}\" is not instant, draft, standard or high", name));
}

/// Numbers of the quality that the user wants otherwise; 0 or −1: as the quality says.
struct Overrides {
  int size = 0;
  int train_frames = 0;
  int test_frames = 0;
  size_t budget = 0;
  size_t steps = 0;
  int sh_degree = -1;
};

struct BuildArguments {
  std::string volume;
  std::string output;
  LookArguments look;
  std::string quality = "standard";
  std::string model = "explicit";
  std::string work;
  std::string title;
  std::uint64_t seed = 1;
  LoadOptions loading;
  SectionChoice section;
  bool denoise = false;
  Overrides overrides;
  DatasetOptions tests;  ///< what add_test_picture_options() sets
};

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

void run_instant_build(const BuildArguments& arguments) {
  require_writable(arguments.output);
  require_volume(arguments);
  const Volume volume = load_volume(arguments.volume, arguments.loading);
  build_instant_case(volume, load_look(arguments.look, volume),
                     {arguments.section, !arguments.look.as_scanned, arguments.title},
                     arguments.output);
}

void run_build(const BuildArguments& arguments) {
  if (arguments.quality == kInstant) {
    run_instant_build(arguments);
    return;
  }
  const BuildOptions options = build_options(arguments);
  require_writable(arguments.output);
  const fs::path folder = work_folder(arguments);
  fmt::print(stderr, "[1/4] {}: work is kept in {}\n", arguments.volume, folder.string());
  require_volume(arguments);
  const FolderLock work(folder, "give this build its own folder with --work");
  Volume volume = load_volume(arguments.volume, arguments.loading);
  const Preset preset = load_look(arguments.look, volume);
  build_case(std::move(volume), preset, options, work, arguments.output);
}

/// Of a case that is there at once nothing is traced and nothing trained.
void require_no_training(const CLI::App& command) {
  for (const char* name :
       {"--model", "--work", "--seed", "--denoise", "--size", "--train-frames", "--test-frames",
        "--test-size", "--uncut-frames", "--close-frames", "--cut-views", "--test-noise-db",
        "--test-masked-noise-db", "--budget", "--steps", "--sh-degree"}) {
    if (command.get_option(name)->count() > 0) {
      throw CLI::ValidationError(
          name, "--quality instant traces no pictures and trains nothing; leave one of them out");
    }
  }
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

/// Before the first takes its time: the last can be built, too. Throws Error.
void require_looks(const std::vector<BuildArguments>& builds) {
  require_volume(builds.front());
  const Volume volume = load_volume(builds.front().volume, builds.front().loading);
  for (const BuildArguments& build : builds) {
    require_writable(build.output);
    require_look_for_section(load_look(build.look, volume), build.section);
  }
}

/// One case for each preset of --preset.
void run_builds(const BuildArguments& arguments) {
  const std::vector<std::string> presets = presets_of(arguments.look.preset);
  if (presets.size() == 1) {
    run_build(arguments);
    return;
  }
  std::vector<BuildArguments> builds;
  for (const std::string& preset : presets) {
    builds.push_back(build_of_look(arguments, preset));
  }
  require_looks(builds);
  for (const BuildArguments& build : builds) {
    run_build(build);
  }
}

}  // namespace

void add_build_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("build", "From a volume to a case: pictures, training, packing");
  const auto arguments = std::make_shared<BuildArguments>();
  command
      ->add_option("volume", arguments->volume,
                   "DICOM (folder, file or .zip), NIfTI, NRRD or MetaImage")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Case to write (.sog); of several presets OUTPUT-PRESET.sog each")
      ->required()
      ->check(ends_in({".sog"}));
  add_look_options(*command, arguments->look);
  command->get_option("--preset")
      ->description(
          "Look: a preset's name, a JSON file, or auto; several with commas between them: a case "
          "of "
          "each, which the viewer shows as looks of one volume");
  add_label_options(*command, arguments->look.labels, arguments->loading);
  command
      ->add_option("--quality", arguments->quality,
                   "instant (seconds, nothing trained), draft, standard or high")
      ->capture_default_str();
  command
      ->add_option("--model", arguments->model,
                   "explicit: Gaussians trained under cuts of any angle; clipgs: a neural model, "
                   "baked into 200 layers and refined, as the papers have it")
      ->check(CLI::IsMember({"explicit", "clipgs"}))
      ->capture_default_str();
  command->add_option("--work", arguments->work,
                      "Folder for the work in progress, of several presets with a folder of each "
                      "(default: OUTPUT.clipgs-work)");
  command->add_option("--title", arguments->title,
                      "Title of the case (default: the preset's name)");
  command->add_option("--seed", arguments->seed, "Seed of everything random")
      ->capture_default_str();
  add_section_options(*command, arguments->section);
  add_section_coding(*command, arguments->section);
  add_volume_options(*command, arguments->loading);
  arguments->loading.work = [&arguments = *arguments](const VolumeSize& size) {
    return dataset_memory(size, arguments.section, !arguments.look.as_scanned);
  };
  Overrides& overrides = arguments->overrides;
  command->add_option("--size", overrides.size, "Side of the pictures, px")
      ->check(CLI::Range(32, 4096))
      ->group("Instead of what the quality says");
  command->add_option("--train-frames", overrides.train_frames, "Training pictures")
      ->check(CLI::Range(1, 100000))
      ->group("Instead of what the quality says");
  command
      ->add_option("--test-frames", overrides.test_frames,
                   "Test pictures of each split, and half as many to validate by")
      ->check(CLI::Range(1, 10000))
      ->group("Instead of what the quality says");
  add_test_picture_options(*command, arguments->tests, "Instead of what the quality says");
  command->add_flag("--denoise", arguments->denoise,
                    "Smooth noise of training pictures away; test pictures stay as traced");
  command->add_option("--budget", overrides.budget, "Gaussians at most")
      ->check(CLI::Range(100, 5000000))
      ->group("Instead of what the quality says");
  command->add_option("--steps", overrides.steps, "Training steps")
      ->check(CLI::Range(1, 10000000))
      ->group("Instead of what the quality says");
  command->add_option("--sh-degree", overrides.sh_degree, "Degree of the colours' view dependence")
      ->check(CLI::Range(0, kMaxShDegree))
      ->group("Instead of what the quality says");
  command->footer(
      "An interrupted build resumes when it is run again, and what depends on a changed volume,\n"
      "look or option is made again; the rest is kept. One build at a time works in a work "
      "folder.\n"
      "It keeps the pictures for clipgs eval; delete it when you do not need them.\n"
      "Example: clipgs build dicom/ -o case.sog\n"
      "         clipgs build dicom/ -o case.sog --quality instant\n"
      "         clipgs build dicom/ -o case.sog --preset skin,skeleton,surgery");
  command->callback([command, arguments] {
    if (arguments->quality == kInstant) {
      require_no_training(*command);
    }
    leave_section_to_splats(arguments->loading, arguments->section);
    run_builds(*arguments);
  });
}

}  // namespace clipgs
