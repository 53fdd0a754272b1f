#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "pipeline/section_step.h"

#include "asset/case.h"
#include "bake/bake.h"
#include "cinema/dataset.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/error.h"
#include "core/file.h"
#include "measure/evaluation.h"
#include "measure/report.h"
#include "train/model_file.h"
#include "volume/preset.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

struct EvalArguments {
  std::string scene;
  std::vector<std::string> others;
  std::string model;
  std::string dataset;
  std::string json;
  std::string report;
  std::vector<std::string> clips = {"hard", "soft", "exact"};
  std::vector<std::string> sections;
  std::string split = "test";
  std::string rig;
  float pixels_per_degree = kHeadsetPixelsPerDegree;
  int size = 0;
};

EvaluationOptions evaluation_options(const EvalArguments& arguments) {
  EvaluationOptions options;
  if (arguments.split == "validation") {
    options.splits = kValidationSplits;
  }
  options.pixels_per_degree = arguments.pixels_per_degree;
  options.clips.clear();
  for (const std::string& name : arguments.clips) {
    const ClipOperator clip = parse_clip_operator(name);
    if (std::ranges::find(options.clips, clip) == options.clips.end()) {
      options.clips.push_back(clip);
    }
  }
  const std::vector<std::string> relit = {face_source_name(FaceSource::kVolume)};
  for (const std::string& name : arguments.rig.empty() ? arguments.sections : relit) {
    const FaceSource source = parse_face_source(name);
    if (std::ranges::find(options.faces, source) == options.faces.end()) {
      options.faces.push_back(source);
    }
  }
  return options;
}

/// The outputs can be written and are none of the scenes (a PLY's description is a JSON file).
void check_outputs(const EvalArguments& arguments) {
  std::vector<std::string> scenes = arguments.others;
  scenes.push_back(arguments.scene);
  scenes.push_back(arguments.model);
  for (const fs::path output : {arguments.json, arguments.report}) {
    if (output.empty()) {
      continue;
    }
    std::error_code error;  // a file that does not exist is no other file
    for (const std::string& scene : scenes) {
      if (fs::equivalent(scene, output, error) ||
          fs::equivalent(fs::path(scene).replace_extension(".json"), output, error)) {
        throw Error("{}: belongs to the scene and would be overwritten; choose another name",
                    output.string());
      }
    }
    require_writable(output);
  }
}

/// The scene, the others and the model, in this order. Those that come for comparison may have
/// faces drawn from the dataset's section if they have none of their own.
std::vector<Case> load_subjects(const EvalArguments& arguments, const Dataset& dataset) {
  std::vector<Case> cases;
  cases.push_back(load_case(arguments.scene));
  const std::optional<Section> section = read_dataset_section(dataset);
  const auto add = [&](const std::string& path) {
    cases.push_back(load_case(path));
    if (!cases.back().section) {
      cases.back().section = section;
    }
  };
  for (const std::string& path : arguments.others) {
    add(path);
  }
  if (!arguments.model.empty()) {
    if (!is_model(arguments.model)) {
      throw Error("{}: is no neural model; make one with clipgs train --model clipgs",
                  arguments.model);
    }
    add(arguments.model);
  }
  std::ranges::for_each(cases, prepare_openings);
  if (!arguments.rig.empty()) {
    const LightRig rig = load_rig(arguments.rig);
    for (Case& contents : cases) {
      relight(contents, rig);
    }
  }
  return cases;
}

/// What ClipGS-VR's steps leave of the model's states, and the file that is measured.
std::vector<SizeStage> size_stages(const fs::path& file, const Scene& scene, const Case& model) {
  const int count = scene.states.count > 0 ? scene.states.count : kDefaultStates;
  const BakeStatistics bytes = bake({model.scene, *model.model}, count).statistics;
  return {{fmt::format("{} states as PLY", count), bytes.raw_bytes},
          {"view dependence shared", bytes.shared_sh_bytes},
          {"a slab of each state", bytes.slab_bytes},
          {"one scene with layers", bytes.consolidated_bytes},
          {file.filename().string(), fs::file_size(file)}};
}

void run_eval(const EvalArguments& arguments) {
  const EvaluationOptions options = evaluation_options(arguments);
  check_outputs(arguments);
  Dataset dataset = load_dataset(arguments.dataset);
  if (arguments.size > 0) {
    show_at_size(arguments.size, dataset);
  }
  const std::vector<Case> cases = load_subjects(arguments, dataset);
  if (std::ranges::find(options.clips, ClipOperator::kLayers) != options.clips.end() &&
      std::ranges::all_of(cases, [](const Case& one) { return one.scene.layers.empty(); })) {
    throw Error("{}: has no layers to clip by; clipgs bake makes them of a neural model",
                arguments.scene);
  }
  std::vector<Subject> subjects = {{fs::path(arguments.scene).stem().string(), cases.data()}};
  for (size_t i = 0; i < arguments.others.size(); ++i) {
    subjects.push_back({fs::path(arguments.others[i]).stem().string(), &cases[i + 1]});
  }
  if (!arguments.model.empty()) {
    subjects.push_back({fs::path(arguments.model).stem().string(), &cases.back()});
  }
  Evaluation evaluation = evaluate(subjects, dataset, options);
  evaluation.bytes = fs::file_size(arguments.scene);
  if (!arguments.model.empty()) {
    evaluation.sizes = size_stages(arguments.scene, cases.front().scene, cases.back());
  }
  if (!arguments.json.empty()) {
    write_text(arguments.json, evaluation_json(evaluation, dataset));
  }
  if (!arguments.report.empty()) {
    write_text(arguments.report, evaluation_report(subjects, dataset, evaluation));
  }
  fmt::print("{}", evaluation_table(evaluation, dataset));
}

}  // namespace

void add_eval_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "eval", "Measure a case or scene against a dataset's path-traced pictures");
  const auto arguments = std::make_shared<EvalArguments>();
  command->add_option("scene", arguments->scene, "Case (.sog) or scene (.ply)")->required();
  command->add_option("--dataset", arguments->dataset, "Folder that clipgs dataset or build made")
      ->required();
  command
      ->add_option("--with", arguments->others,
                   "Another scene to measure beside it; may be given again")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  CLI::Option* const model =
      command->add_option("--model", arguments->model,
                          "The neural model that the scene was baked from: measured beside it, and "
                          "scenes against its pictures, with the bytes of each step of baking");
  // A scene's own description has its name and .json.
  command->add_option("--json", arguments->json, "File to write the figures to, as JSON")
      ->check(ends_in({".json", ".figures"}));
  command
      ->add_option("--report", arguments->report,
                   "HTML page to write: figures, and truth and ours side by side")
      ->check(ends_in({".html", ".htm"}));
  command
      ->add_option("--clip", arguments->clips,
                   "Clip operators: hard, soft, exact, layers (of cuts along the axis)")
      ->delimiter(',')
      ->check(CLI::IsMember({"hard", "soft", "exact", "layers"}))
      ->capture_default_str();
  CLI::Option* const section =
      command
          ->add_option(
              "--section", arguments->sections,
              "What draws the faces of the cut: volume, splats (default: what the case has)")
          ->delimiter(',')
          ->check(CLI::IsMember({"volume", "splats"}));
  command
      ->add_option("--split", arguments->split,
                   "Pictures: test, for tables, or validation, to choose between methods by")
      ->check(CLI::IsMember({"test", "validation"}))
      ->capture_default_str();
  command
      ->add_option("--rig", arguments->rig,
                   "Lights that scenes are shown in, such as those of the dataset: studio, "
                   "theatre, rim, dome, ambient or a JSON file (default: those that each was "
                   "made in); with faces from the volume")
      ->excludes(section, model);
  command
      ->add_option(
          "--size", arguments->size,
          "Side of the pictures to compare, px: one that divides the dataset's, whose pixels "
          "are averaged (default: as they are)")
      ->check(CLI::Range(16, 4096));
  command
      ->add_option("--pixels-per-degree", arguments->pixels_per_degree,
                   "Of the display that FLIP is told for: 25 is a Quest 3, 67 a desk")
      ->check(CLI::Range(1.0f, 1000.0f))
      ->capture_default_str();
  command->footer(
      "Scenes are called by their files' names.\n"
      "Example: clipgs eval case.sog --dataset case.clipgs-work/dataset --report case.html\n"
      "         clipgs eval refined.ply --with layered.ply --model neural.ply --dataset dataset/");
  command->callback([arguments] { run_eval(*arguments); });
}

}  // namespace clipgs
