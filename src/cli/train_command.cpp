#include <memory>

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

struct TrainArguments {
  std::string dataset;
  std::string output;
  std::string clip = "exact";
  bool no_section = false;
  std::string model = "explicit";
  std::string truncation = "learned";
  std::string aam_sees = "shape";
  bool no_lt = false;
  bool no_aam = false;
  UniaxialOptions uniaxial;
  TrainOptions options;
};

void run_train(const TrainArguments& arguments) {
  require_writable(arguments.output);
  const FileLock lock(arguments.output + ".lock", arguments.output, "choose another name");
  const Dataset dataset = load_dataset(arguments.dataset);
  TrainOptions options = arguments.options;
  options.clip = parse_clip_operator(arguments.clip);
  options.start = options.budget;
  const std::string checkpoint = arguments.output + ".checkpoint";
  const std::optional<Section> section =
      arguments.no_section ? std::nullopt : read_dataset_section(dataset);
  const Section* const faces = section ? &*section : nullptr;
  if (arguments.model == "clipgs") {
    options.uniaxial = arguments.uniaxial;
    options.uniaxial->truncation =
        arguments.no_lt ? Truncation::kNone : parse_truncation(arguments.truncation);
    options.uniaxial->adjust = !arguments.no_aam;
    options.uniaxial->adjustment.shape = arguments.aam_sees == "shape";
    const UniaxialModel model = train_model(dataset, options, checkpoint, faces);
    write_scene_section(arguments.output, faces);
    write_model(arguments.output, model);
  } else {
    const Scene scene = train(dataset, options, checkpoint, faces);
    write_scene_section(arguments.output, faces);
    write_scene(arguments.output, scene);
  }
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
      ->required()
      ->check(ends_in({".ply"}));
  add_step_quality(*command,
                   "Gaussians, steps (with --model clipgs half of them) and degree of colours",
                   [&arguments = *arguments](const Quality& quality) {
                     arguments.options.budget = quality.budget;
                     arguments.options.steps = quality.steps;
                     arguments.options.sh_degree = quality.sh_degree;
                   });
  command->add_option("--budget", options.budget, "Gaussians at most")
      ->check(CLI::Range(100, 5000000))
      ->capture_default_str();
  command->add_option("--steps", options.steps, "Training steps")
      ->check(CLI::Range(1, 10000000))
      ->capture_default_str();
  command->add_option("--sh-degree", options.sh_degree, "Degree of the colours' view dependence")
      ->check(CLI::Range(0, kMaxShDegree))
      ->capture_default_str();
  command->add_option("--clip", arguments->clip, "Clip operator in the loop: hard, soft or exact")
      ->check(CLI::IsMember({"hard", "soft", "exact"}))
      ->capture_default_str();
  command->add_flag("--no-section", arguments->no_section,
                    "Leave the dataset's section out: splats fill the cut faces");
  command
      ->add_option(
          "--model", arguments->model,
          "explicit: Gaussians that any plane cuts; clipgs: the neural model, which planes "
          "across the dataset's axis cut (clipgs dataset --one-sided)")
      ->check(CLI::IsMember({"explicit", "clipgs"}))
      ->capture_default_str();
  UniaxialOptions& uniaxial = arguments->uniaxial;
  const char* const group = "With --model clipgs";
  command
      ->add_option("--truncation", arguments->truncation,
                   "What the plane hides: hard (centres behind it) or learned (a threshold of each "
                   "Gaussian)")
      ->check(CLI::IsMember({"hard", "learned"}))
      ->capture_default_str()
      ->group(group);
  command->add_flag("--no-lt", arguments->no_lt, "No truncation: the adjustment alone cuts")
      ->group(group);
  command->add_flag("--no-aam", arguments->no_aam, "No adaptive adjustment model")->group(group);
  command
      ->add_option("--aam-sees", arguments->aam_sees,
                   "Inputs of the adjustment: shape (centre, plane, and how the plane cuts the "
                   "Gaussian) or position (centre and plane, as in the paper)")
      ->check(CLI::IsMember({"shape", "position"}))
      ->capture_default_str()
      ->group(group);
  command
      ->add_option("--window", uniaxial.adjustment.window,
                   "Share of the extent, to either side of the plane, in which Gaussians are "
                   "adjusted (0: everywhere)")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str()
      ->group(group);
  command->add_option("--seed", options.seed, "Seed of everything random")->capture_default_str();
  command->footer(
      "Resumes from OUTPUT.checkpoint after an interruption.\n"
      "Example: clipgs train dataset/ -o scene.ply --budget 100000 --steps 20000");
  command->callback([arguments, command] {
    if (arguments->no_lt && arguments->no_aam) {
      throw CLI::ValidationError("--no-lt", "with --no-aam nothing would cut");
    }
    if (arguments->model != "clipgs" &&
        (arguments->no_lt || arguments->no_aam || command->count("--truncation") > 0 ||
         command->count("--window") > 0 || command->count("--aam-sees") > 0)) {
      throw CLI::ValidationError(
          "--model",
          "--truncation, --no-lt, --no-aam, --aam-sees and --window belong to --model clipgs");
    }
    if (arguments->model == "clipgs" && command->count("--quality") > 0 &&
        command->count("--steps") == 0) {
      arguments->options.steps /= 2;  // the other half refines what is baked
    }
    run_train(*arguments);
  });
}

}  // namespace clipgs
