#include <memory>
#include <optional>

#include "pipeline/section_step.h"

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/quality.h"
#include "core/error.h"
#include "core/file.h"
#include "core/lock.h"
#include "splat/scene_file.h"
#include "train/model_file.h"
#include "train/trainer.h"

namespace clipgs {

namespace {

struct RefineArguments {
  std::string scene;
  std::string dataset;
  std::string output;
  std::string clip = "exact";
  bool no_section = false;
  std::optional<int> sh_degree;
  TrainOptions options = refine_options();
};

void run_refine(const RefineArguments& arguments) {
  require_writable(arguments.output);
  const FileLock lock(arguments.output + ".lock", arguments.output, "choose another name");
  if (is_model(arguments.scene)) {
    throw Error("{}: is a neural model; make a scene of it with clipgs bake first",
                arguments.scene);
  }
  Scene scene = read_scene(arguments.scene);
  if (arguments.sh_degree) {
    scene.gaussians =
        scene.gaussians.reshaped(*arguments.sh_degree, scene.gaussians.has_face_colors());
  }
  const Dataset dataset = load_dataset(arguments.dataset);
  TrainOptions options = arguments.options;
  options.clip = parse_clip_operator(arguments.clip);
  const std::string checkpoint = arguments.output + ".checkpoint";
  const std::optional<Section> section =
      arguments.no_section ? std::nullopt : read_dataset_section(dataset);
  const Section* const faces = section ? &*section : nullptr;
  const Scene refined = refine(scene, dataset, options, checkpoint, faces);
  write_scene_section(arguments.output, faces);
  write_scene(arguments.output, refined);
  std::filesystem::remove(checkpoint);
}

}  // namespace

void add_refine_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "refine", "Tune a scene against path-traced pictures of any cut, with the clip in the loop");
  const auto arguments = std::make_shared<RefineArguments>();
  TrainOptions& options = arguments->options;
  command->add_option("scene", arguments->scene, "Scene (.ply), as clipgs bake writes it")
      ->required();
  command->add_option("--dataset", arguments->dataset, "Folder made by clipgs dataset")->required();
  command->add_option("-o,--output", arguments->output, "Scene to write (.ply)")
      ->required()
      ->check(ends_in({".ply"}));
  add_step_quality(*command, "Steps, half of the build's", [&options](const Quality& quality) {
    options.steps = quality.steps - quality.steps / 2;
  });
  command->add_option("--steps", options.steps, "Training steps")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  command
      ->add_option("--budget", options.budget,
                   "Gaussians at most (default: as many as the scene has)")
      ->check(CLI::Range(100, 5000000));
  command
      ->add_option("--sh-degree", arguments->sh_degree,
                   "Degree of the colours' view dependence (default: the scene's)")
      ->check(CLI::Range(0, kMaxShDegree));
  command->add_option("--clip", arguments->clip, "Clip operator in the loop: hard, soft or exact")
      ->check(CLI::IsMember({"hard", "soft", "exact"}))
      ->capture_default_str();
  command->add_flag("--no-section", arguments->no_section,
                    "Leave the dataset's section out: splats fill the cut faces");
  command->add_option("--seed", options.seed, "Seed of everything random")->capture_default_str();
  command->footer(
      "Resumes from OUTPUT.checkpoint after an interruption.\n"
      "Example: clipgs refine layered.ply --dataset dataset/ -o refined.ply");
  command->callback([arguments] { run_refine(*arguments); });
}

}  // namespace clipgs
