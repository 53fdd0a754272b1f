#include <memory>
#include <string>

#include "asset/case.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/file.h"
#include "splat/ply.h"
#include "splat/similarity.h"

namespace clipgs {

namespace {

struct ExportArguments {
  std::string input;
  std::string output;
  std::string format = "ply";
};

void run_export(const ExportArguments& arguments) {
  require_writable(arguments.output);
  const Gaussians gaussians = load_case(arguments.input).scene.gaussians;
  // Other programs cut nothing: face colours are of no use to them.
  write_ply(arguments.output, transform(gaussians.reshaped(gaussians.sh_degree(), false),
                                        scene_to_world().inverse()));
}

}  // namespace

void add_export_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("export", "Write a case's Gaussians, uncut, for other programs");
  const auto arguments = std::make_shared<ExportArguments>();
  command->add_option("case", arguments->input, "Case (.sog) or scene (.ply)")->required();
  command->add_option("-o,--output", arguments->output, "File to write (.ply)")
      ->required()
      ->check(ends_in({".ply"}));
  command->add_option("--format", arguments->format, "ply: 3D Gaussian Splatting, metres, y down")
      ->check(CLI::IsMember({"ply"}))
      ->capture_default_str();
  command->footer("Example: clipgs export case.sog -o splats.ply --format ply");
  command->callback([arguments] { run_export(*arguments); });
}

}  // namespace clipgs
