#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <vector>

#include "asset/case.h"
#include "cinema/dataset.h"
#include "cli/commands.h"
#include "core/file.h"
#include "measure/evaluation.h"
#include "measure/report.h"
#include "splat/render.h"
#include "splat/scene_file.h"

namespace clipgs {

namespace {

struct EvalArguments {
  std::string scene;
  std::string dataset;
  std::string json;
  std::string report;
  std::vector<std::string> clips = {"hard", "soft", "exact"};
};

EvaluationOptions evaluation_options(const EvalArguments& arguments) {
  EvaluationOptions options;
  options.clips.clear();
  for (const std::string& name : arguments.clips) {
    const ClipOperator clip = parse_clip_operator(name);
    if (std::ranges::find(options.clips, clip) == options.clips.end()) {
      options.clips.push_back(clip);
    }
  }
  return options;
}

void run_eval(const EvalArguments& arguments) {
  const EvaluationOptions options = evaluation_options(arguments);
  for (const std::string& output : {arguments.json, arguments.report}) {
    if (!output.empty()) {
      require_writable(output);
    }
  }
  const bool is_ply = std::filesystem::path(arguments.scene).extension() == ".ply";
  const Scene scene = is_ply ? read_scene(arguments.scene) : read_case(arguments.scene);
  const Dataset dataset = load_dataset(arguments.dataset);
  Evaluation evaluation = evaluate(scene, dataset, options);
  evaluation.bytes = std::filesystem::file_size(arguments.scene);
  if (!arguments.json.empty()) {
    write_text(arguments.json, evaluation_json(evaluation));
  }
  if (!arguments.report.empty()) {
    write_text(arguments.report, evaluation_report(scene, dataset, evaluation));
  }
  fmt::print("{}", evaluation_table(evaluation));
}

}  // namespace

void add_eval_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "eval", "Measure a case or scene against a dataset's path-traced test pictures");
  const auto arguments = std::make_shared<EvalArguments>();
  command->add_option("scene", arguments->scene, "Case (.sog) or scene (.ply)")->required();
  command->add_option("--dataset", arguments->dataset, "Folder that clipgs dataset or build made")
      ->required();
  command->add_option("--json", arguments->json, "File to write the figures to");
  command->add_option("--report", arguments->report,
                      "HTML page to write: figures, and truth and ours side by side");
  command->add_option("--clip", arguments->clips, "Clip operators: hard, soft, exact")
      ->delimiter(',')
      ->capture_default_str();
  command->footer(
      "Example: clipgs eval case.sog --dataset case.clipgs-work/dataset --report case.html");
  command->callback([arguments] { run_eval(*arguments); });
}

}  // namespace clipgs
