#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "pipeline/section_step.h"

#include "cinema/make_dataset.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/look_options.h"
#include "cli/quality.h"
#include "cli/section_options.h"
#include "cli/test_picture_options.h"
#include "cli/volume_options.h"
#include "core/lock.h"

namespace clipgs {
namespace {

struct DatasetArguments {
  std::filesystem::path volume;
  std::filesystem::path folder;
  LoadOptions load;
  LookArguments look;
  std::string axis = "0,0,1";
  std::string views;                // empty: need with a section, spiral without
  std::optional<float> near_share;  // none: the usual one
  DatasetOptions options;
  int validation_frames = -1;  // as the tests say
  SectionChoice section;
  bool json = false;
};

float lowest(const std::vector<const Frame*>& frames, float Frame::* noise) {
  return (*std::ranges::min_element(frames, {}, noise))->*noise;
}

void run_dataset(const DatasetArguments& arguments) {
  DatasetOptions options = arguments.options;
  options.axis = parse_vector(arguments.axis, "--axis");
  if (!(glm::length(options.axis) > 0)) {
    throw CLI::ValidationError("--axis", "the axis must not be 0,0,0");
  }
  options.axis = glm::normalize(options.axis);
  options.validation_frames = arguments.validation_frames >= 0 ? arguments.validation_frames
                                                               : (options.test_frames + 1) / 2;
  options.choose_views =
      arguments.views.empty() ? !arguments.section.none : arguments.views == "need";
  options.near_share = arguments.near_share.value_or(usual_near_share(options));
  options.upsample = !arguments.look.as_scanned;
  const FolderLock lock(arguments.folder);
  const Volume volume = load_volume(arguments.volume, arguments.load);
  const Preset preset = load_look(arguments.look, volume);
  require_look_for_section(preset, arguments.section);
  TracedVolume traced(volume, preset, options.upsample);
  const Dataset dataset = make_dataset(traced, preset, arguments.folder, options);
  make_dataset_section(traced, preset, dataset, arguments.section);

  nlohmann::ordered_json json = {{"dataset", arguments.folder.string()},
                                 {"preset", preset.name},
                                 {"frames", dataset.frames.size()}};
  std::string text = fmt::format("{}: preset {}", arguments.folder.string(), preset.name);
  for (const Split split : kSplits) {
    const std::vector<const Frame*> frames = dataset.split(split);
    if (!frames.empty()) {
      const float noise = lowest(frames, &Frame::noise_db);
      const float masked = lowest(frames, &Frame::masked_noise_db);
      json["lowest_noise_db"][split_name(split)] = noise;
      json["lowest_masked_noise_db"][split_name(split)] = masked;
      text += fmt::format(", {} {} (noise floor >= {:.1f} dB, masked {:.1f} dB)", frames.size(),
                          split_name(split), noise, masked);
    }
  }
  fmt::print("{}\n", arguments.json ? json.dump(2) : text);
}

}  // namespace

void add_dataset_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("dataset", "Path-trace the training and test pictures of a volume");
  command->footer("Example: clipgs dataset ct.nii.gz -o dataset/ --train-frames 400 --size 256");
  const auto arguments = std::make_shared<DatasetArguments>();
  DatasetOptions& options = arguments->options;
  add_volume_argument(*command, arguments->volume);
  command
      ->add_option(
          "-o,--output", arguments->folder,
          "Folder to fill; an interrupted run goes on where it stopped, and what depends on "
          "a change is made again")
      ->required();
  add_step_quality(*command, "Size, number and samples of pictures, and seed points",
                   [&options](const Quality& quality) {
                     options.size = quality.size;
                     options.train_frames = quality.train_frames;
                     options.test_frames = quality.test_frames;
                     options.train_spp = quality.train_spp;
                     options.seed_points = std::max(options.seed_points, quality.budget);
                   });
  add_look_options(*command, arguments->look);
  add_label_options(*command, arguments->look.labels, arguments->load);
  command->add_option("--size", options.size, "Pixels a side")
      ->check(CLI::Range(16, 4096))
      ->capture_default_str();
  command->add_option("--train-frames", options.train_frames, "Training pictures")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--test-frames", options.test_frames, "Pictures of each test split")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command
      ->add_option("--validation-frames", arguments->validation_frames,
                   "Pictures of each validation split, to choose between methods by (default: half "
                   "as many as test pictures)")
      ->check(CLI::Range(0, 10000));
  add_test_picture_options(*command, options, "OPTIONS");
  command->add_option("--train-spp", options.train_spp, "Samples a pixel of training pictures")
      ->check(CLI::Range(2, 65536))
      ->capture_default_str();
  command
      ->add_option("--test-spp", options.test_spp,
                   "Most samples a pixel, on average, that a test picture may take to get there")
      ->check(CLI::Range(2, 1 << 20))
      ->capture_default_str();
  command->add_option("--bounces", options.max_bounces, "Most vertices of a path")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--points", options.seed_points, "Seed points for training")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  command->add_option("--axis", arguments->axis, "Normal of the axis planes, RAS")
      ->capture_default_str();
  command->add_flag("--one-sided", options.one_sided,
                    "Axis planes keep what is below them: for clipgs train --model clipgs");
  command
      ->add_option("--views", arguments->views,
                   "Training views and planes: need (by what they show; the default) or spiral "
                   "(evenly spread; the default with --no-section)")
      ->check(CLI::IsMember({"need", "spiral"}));
  command
      ->add_option("--near-share", arguments->near_share,
                   "Share of the training pictures that show a quarter of the view, twice as large "
                   "(default: 0.5; 0 with --views spiral, --no-section or --one-sided)")
      ->check(CLI::Range(0.0f, 1.0f));
  command->add_option("--seed", options.seed, "Random seed")->capture_default_str();
  command->add_flag("--denoise", options.denoise,
                    "Smooth noise of training pictures away; test pictures stay as traced");
  command->add_flag("--json", arguments->json, "Print the figures as JSON");
  add_section_options(*command, arguments->section);
  add_volume_options(*command, arguments->load);
  arguments->load.warn_of_face = true;
  arguments->load.work = [&arguments = *arguments](const VolumeSize& size) {
    return dataset_memory(size, arguments.section, !arguments.look.as_scanned);
  };
  command->callback([arguments] {
    leave_section_to_splats(arguments->load, arguments->section);
    run_dataset(*arguments);
  });
}

}  // namespace clipgs
