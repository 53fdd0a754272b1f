#include <fmt/format.h>
#include <memory>

#include "pipeline/build_case.h"
#include "pipeline/instant_case.h"

#include "cli/build_arguments.h"
#include "cli/commands.h"
#include "cli/test_picture_options.h"
#include "core/error.h"
#include "core/file.h"
#include "volume/load.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

void run_instant_build(const BuildArguments& arguments) {
  require_writable(arguments.output);
  require_volume(arguments);
  const Volume volume = load_volume(arguments.volume, arguments.loading);
  build_instant_case(volume, load_look(arguments.look, volume),
                     {arguments.section, !arguments.look.as_scanned, arguments.title},
                     arguments.output);
}

void run_build(const BuildArguments& arguments) {
  if (arguments.instant()) {
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

/// One case for each preset of --preset.
void run_builds(const BuildArguments& arguments) {
  const std::vector<BuildArguments> builds = builds_of_looks(arguments);
  if (builds.size() > 1) {
    require_looks(builds);
  }
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
  add_build_options(*command, *arguments);
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
      "         clipgs build dicom/ -o case.sog --preset skin,skeleton,surgery");
  command->callback([command, arguments] {
    if (arguments->instant()) {
      require_no_training(*command);
    }
    leave_section_to_splats(arguments->loading, arguments->section);
    run_builds(*arguments);
  });
}

}  // namespace clipgs
