#include <memory>

#include "cli/commands.h"
#include "cli/section_step.h"
#include "core/file.h"
#include "splat/scene_file.h"
#include "train/trainer.h"

namespace clipgs {

namespace {

struct TrainArguments {
  std::string dataset;
  std::string output;
  std::string clip = "exact";
  bool no_section = false;
  TrainOptions options;
};

void run_train(const TrainArguments& arguments) {
  require_writable(arguments.output);
  const Dataset dataset = load_dataset(arguments.dataset);
  TrainOptions options = arguments.options;
  options.clip = parse_clip_operator(arguments.clip);
  options.start = options.budget;
  const std::string checkpoint = arguments.output + ".checkpoint";
  const std::optional<Section> section =
      arguments.no_section ? std::nullopt : read_dataset_section(dataset);
  const Section* const faces = section ? &*section : nullptr;
  const Scene scene = train(dataset, options, checkpoint, faces);
  write_scene_section(arguments.output, faces);
  write_scene(arguments.output, scene);
  std::filesystem::remove(checkpoint);
}

}  // namespace

void add_train_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("train", "Fit Gaussians to a cinematic dataset");
  const auto arguments = std::make_shared<TrainArguments>();
  TrainOptions& options = arguments->options;
  command->add_option("dataset", arguments->dataset, "Folder made by clipgs dataset")->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Scene to write (.ply; .json and .section.zip beside it)")
      ->required();
  command->add_option("--budget", options.budget, "Gaussians at most")
      ->check(CLI::Range(1000, 2000000))
      ->capture_default_str();
  command->add_option("--steps", options.steps, "Training steps")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--sh-degree", options.sh_degree, "Degree of the colours' view dependence")
      ->check(CLI::Range(0, kMaxShDegree))
      ->capture_default_str();
  command->add_option("--clip", arguments->clip, "Clip operator in the loop: hard, soft or exact")
      ->capture_default_str();
  command->add_flag("--no-section", arguments->no_section,
                    "Leave the dataset's section out: splats fill the cut faces");
  command->add_option("--seed", options.seed, "Seed of everything random")->capture_default_str();
  command->footer(
      "Resumes from OUTPUT.checkpoint after an interruption.\n"
      "Example: clipgs train dataset/ -o scene.ply --budget 100000 --steps 20000");
  command->callback([arguments] { run_train(*arguments); });
}

}  // namespace clipgs
