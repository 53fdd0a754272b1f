#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "pipeline/build_case.h"
#include "pipeline/build_needs.h"
#include "pipeline/instant_case.h"

#include "cli/archive_volume.h"
#include "cli/build_arguments.h"
#include "cli/commands.h"
#include "cli/test_picture_options.h"
#include "core/error.h"
#include "core/file.h"
#include "volume/load.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

/// Called when a volume has been read.
using Loaded = std::function<void()>;

void run_instant_build(const BuildArguments& arguments, const Loaded& loaded) {
  require_writable(arguments.output);
  require_volume(arguments);
  const Volume volume = load_volume(arguments.volume, arguments.loading);
  loaded();
  build_instant_case(volume, load_look(arguments.look, volume),
                     {arguments.section, !arguments.look.as_scanned, arguments.title},
                     arguments.output);
}

void run_build(const BuildArguments& arguments, const Loaded& loaded) {
  if (arguments.instant()) {
    run_instant_build(arguments, loaded);
    return;
  }
  const BuildOptions options = build_options(arguments);
  require_writable(arguments.output);
  const fs::path folder = work_folder(arguments);
  fmt::print(stderr, "[1/4] {}: work is kept in {}\n", arguments.volume, folder.string());
  require_volume(arguments);
  const FolderLock work(folder, "give this build its own folder with --work");
  Volume volume = load_volume(arguments.volume, arguments.loading);
  loaded();
  const Preset preset = load_look(arguments.look, volume);
  build_case(std::move(volume), preset, options, work, arguments.output);
}

/// What the steps of a build need, as JSON: whole megabytes and seconds, for schedulers.
void print_needs(BuildArguments arguments) {
  const GivenVolume given(arguments.volume, arguments.loading, arguments.archive);
  arguments.volume = given.path();
  require_volume(arguments);
  const VolumeSize size = volume_size(arguments.volume, arguments.loading);
  require_supported(size, arguments.volume);
  nlohmann::ordered_json json = {{"dims", {size.dims.x, size.dims.y, size.dims.z}}};
  const std::vector<StepNeeds> steps =
      arguments.instant() ? instant_needs(size, arguments.section, !arguments.look.as_scanned)
                          : build_needs(size, build_options(arguments));
  for (const StepNeeds& needs : steps) {
    json["steps"][needs.step] = {{"memory_mb", (needs.memory + 999'999) / 1'000'000},
                                 {"seconds", static_cast<int>(std::ceil(needs.seconds))}};
  }
  fmt::print("{}\n", json.dump(2));
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

/// One case for each preset of --preset. What was fetched stays until the last one has read it.
void run_builds(BuildArguments arguments) {
  for (const BuildArguments& build : builds_of_looks(arguments)) {
    require_writable(build.output);
  }
  GivenVolume given(arguments.volume, arguments.loading, arguments.archive);
  arguments.volume = given.path();
  std::vector<BuildArguments> builds = builds_of_looks(arguments);
  builds.front().loading.warn_of_face = true;
  if (builds.size() > 1) {
    require_looks(builds);
    builds.front().loading.warn_of_face = false;  // it was loaded once
  }
  for (const BuildArguments& build : builds) {
    const bool is_last = &build == &builds.back();
    run_build(build, is_last ? Loaded([&given] { given.forget(); }) : [] {});
  }
}

}  // namespace

void add_build_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("build", "From a volume to a case: pictures, training, packing");
  const auto arguments = std::make_shared<BuildArguments>();
  command
      ->add_option("volume", arguments->volume,
                   "DICOM (folder, file or .zip), NIfTI, NRRD or MetaImage, or an address in an "
                   "archive, as clipgs fetch has it")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Case to write (.sog); of several presets OUTPUT-PRESET.sog each")
      ->required()
      ->check(ends_in({".sog"}));
  add_build_options(*command, *arguments);
  add_archive_options(*command, arguments->archive);
  const auto needs = std::make_shared<bool>(false);
  command->add_flag("--needs", *needs,
                    "Build nothing: print what each step will need of memory, and of time on two "
                    "cores, as JSON, from the volume's header alone");
  command
      ->add_option("--model", arguments->model,
                   "explicit: Gaussians trained under cuts of any angle; clipgs: a neural model, "
                   "baked into 200 layers and refined, as the papers have it")
      ->check(CLI::IsMember({"explicit", "clipgs"}))
      ->capture_default_str();
  command->add_option("--work", arguments->work,
                      "Folder for the work in progress, of several presets with a folder of each "
                      "(default: OUTPUT.clipgs-work)");
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
      "         clipgs build dicom/ -o case.sog --preset skin,skeleton,surgery\n"
      "         clipgs build dicom/ -o case.sog --needs\n"
      "         clipgs build dicomweb+https://pacs.example/dicom-web/studies/1.2.3 -o case.sog "
      "--token-file token");
  command->callback([command, arguments, needs] {
    if (arguments->instant()) {
      require_no_training(*command);
    }
    leave_section_to_splats(arguments->loading, arguments->section);
    if (*needs) {
      print_needs(*arguments);
    } else {
      run_builds(*arguments);
    }
  });
}

}  // namespace clipgs
