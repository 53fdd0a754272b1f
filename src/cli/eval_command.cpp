#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "asset/case.h"
#include "cinema/dataset.h"
#include "cli/commands.h"
#include "core/error.h"
#include "core/file.h"
#include "measure/evaluation.h"
#include "measure/report.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

struct EvalArguments {
  std::string scene;
  std::string dataset;
  std::string json;
  std::string report;
  std::vector<std::string> clips = {"hard", "soft", "exact"};
  std::vector<std::string> sections;
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
  for (const std::string& name : arguments.sections) {
    const FaceSource source = parse_face_source(name);
    if (std::ranges::find(options.faces, source) == options.faces.end()) {
      options.faces.push_back(source);
    }
  }
  return options;
}

/// The outputs can be written and are not the scene itself (a PLY's description is a JSON file).
void check_outputs(const EvalArguments& arguments) {
  const fs::path scene = arguments.scene;
  for (const fs::path output : {arguments.json, arguments.report}) {
    if (output.empty()) {
      continue;
    }
    std::error_code error;  // a file that does not exist is no other file
    for (const fs::path& input : {scene, fs::path(scene).replace_extension(".json")}) {
      if (fs::equivalent(input, output, error)) {
        throw Error("{}: belongs to the scene and would be overwritten; choose another name",
                    output.string());
      }
    }
    require_writable(output);
  }
}

void run_eval(const EvalArguments& arguments) {
  const EvaluationOptions options = evaluation_options(arguments);
  check_outputs(arguments);
  const Case contents = load_case(arguments.scene);
  const Dataset dataset = load_dataset(arguments.dataset);
  Evaluation evaluation = evaluate(contents, dataset, options);
  evaluation.bytes = fs::file_size(arguments.scene);
  if (!arguments.json.empty()) {
    write_text(arguments.json, evaluation_json(evaluation));
  }
  if (!arguments.report.empty()) {
    write_text(arguments.report, evaluation_report(contents, dataset, evaluation));
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
      ->check(CLI::IsMember({"hard", "soft", "exact"}))
      ->capture_default_str();
  command
      ->add_option("--section", arguments->sections,
                   "What draws the faces of the cut: volume, splats (default: what the case has)")
      ->delimiter(',')
      ->check(CLI::IsMember({"volume", "splats"}));
  command->footer(
      "Example: clipgs eval case.sog --dataset case.clipgs-work/dataset --report case.html");
  command->callback([arguments] { run_eval(*arguments); });
}

}  // namespace clipgs
