#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/error.h"
#include "core/file.h"
#include "study/comparison.h"
#include "study/grim.h"
#include "study/report_blocks.h"
#include "study/study_csv.h"
#include "study/study_plot.h"
#include "study/study_report.h"
#include "study/study_sessions.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

struct StudyArguments {
  std::vector<std::string> inputs;
  std::vector<std::string> modes;
  std::vector<std::string> checks;
  PowerTarget target;
  std::optional<double> effect;
  std::string format = "text";
  std::string output;
  std::string plot;
  std::string csv;
  std::string json;
};

/// The outputs can be written and are none of what is read.
void require_study_outputs(const StudyArguments& arguments) {
  for (const fs::path output : {arguments.output, arguments.plot, arguments.csv, arguments.json}) {
    if (output.empty()) {
      continue;
    }
    std::error_code error;  // a file that does not exist is no other file
    for (const std::string& input : arguments.inputs) {
      if (fs::equivalent(input, output, error)) {
        throw Error("{}: is read and would be overwritten; choose another name", output.string());
      }
    }
    require_writable(output);
  }
}

StudyTable read_study(const std::vector<std::string>& inputs) {
  StudyTable table;
  for (const std::string& input : inputs) {
    join(table, fs::is_directory(input) ? read_study_sessions(input) : read_study_csv(input));
  }
  return table;
}

ComparisonOptions comparison_options(const StudyArguments& arguments) {
  ComparisonOptions options;
  options.target = arguments.target;
  options.effect = arguments.effect;
  if (!arguments.modes.empty()) {
    options.modes = {arguments.modes[0], arguments.modes[1]};
  }
  return options;
}

void run_study(const StudyArguments& arguments) {
  for (const std::string& check : arguments.checks) {
    fmt::print("{}\n", grim_text(parse_grim_check(check)));
  }
  if (arguments.inputs.empty()) {
    return;
  }
  require_study_outputs(arguments);
  const StudyTable table = read_study(arguments.inputs);
  if (!arguments.csv.empty()) {
    write_text(arguments.csv, study_csv(table));
  }
  const StudyComparison comparison = compare_modes(table, comparison_options(arguments));
  if (!arguments.json.empty()) {
    write_text(arguments.json, study_json(comparison));
  }
  if (!arguments.plot.empty()) {
    write_study_plot(comparison, arguments.plot);
  }
  const std::string report =
      format_report(study_report(comparison), parse_report_format(arguments.format));
  if (arguments.output.empty()) {
    fmt::print("{}{}", arguments.checks.empty() ? "" : "\n", report);
  } else {
    write_text(arguments.output, report);
  }
}

/// "" if a check can be read; what is wrong with it otherwise, as CLI11 has it.
std::string wrong_check(const std::string& text) {
  try {
    parse_grim_check(text);
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}

void add_study_outputs(CLI::App& command, StudyArguments& arguments) {
  command.add_option("--format", arguments.format, "Of the report: text, markdown, latex")
      ->check(CLI::IsMember({"text", "markdown", "latex"}))
      ->capture_default_str();
  command.add_option("-o,--output", arguments.output, "File to write the report to");
  command
      .add_option("--plot", arguments.plot,
                  "Picture to write: every participant's values, and boxes (.svg, .png)")
      ->check(ends_in({".svg", ".png"}));
  command
      .add_option("--export", arguments.csv,
                  "Table to write, of all that was read, for R, pandas or a spreadsheet (.csv)")
      ->check(ends_in({".csv"}));
  command.add_option("--json", arguments.json, "File to write the figures to, as JSON")
      ->check(ends_in({".json"}));
}

}  // namespace

void add_study_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("study", "Compare two modes of a user study: questionnaires and tasks");
  const auto arguments = std::make_shared<StudyArguments>();
  command->add_option("inputs", arguments->inputs,
                      "Folders of sessions that clipgs serve --study recorded, and tables (CSV: "
                      "participant, mode, q1 to q10 or sus, efficiency, ...); joined");
  command
      ->add_option("--modes", arguments->modes,
                   "The two modes: differences are first − second (default: the data's two)")
      ->delimiter(',')
      ->expected(2);
  command
      ->add_option("--check", arguments->checks,
                   "MEAN,N,STEP: whether a printed mean can come from N scores that are multiples "
                   "of STEP (GRIM); may be given again, needs no data")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->check(CLI::Validator(wrong_check, "MEAN,N,STEP"));
  command->add_option("--power", arguments->target.power, "Power to plan the next study for")
      ->capture_default_str();
  command->add_option(
      "--effect", arguments->effect,
      "Its effect, d_z: mean difference over the differences' SD (default: what was "
      "observed)");
  command
      ->add_option("--alpha", arguments->target.alpha,
                   "Two-sided error of tests to plan for; intervals hold the rest")
      ->capture_default_str();
  add_study_outputs(*command, *arguments);
  command->footer(
      "Example: clipgs study recorded/ --plot study.svg --export study.csv\n"
      "         clipgs study answers.csv --modes uniaxial,arbitrary --format latex -o table.tex\n"
      "         clipgs study answers.csv --power 0.9 --effect 0.5\n"
      "         clipgs study --check 71.80,10,2.5 --check 88.20,10,2.5");
  command->callback([arguments] {
    if (arguments->inputs.empty() && arguments->checks.empty()) {
      throw CLI::RequiredError("inputs or --check");
    }
    run_study(*arguments);
  });
}

}  // namespace clipgs
