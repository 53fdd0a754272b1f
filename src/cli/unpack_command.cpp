#include <memory>
#include <string>

#include "pipeline/section_step.h"

#include "asset/case.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/file.h"
#include "splat/scene_file.h"

namespace clipgs {

namespace {

struct UnpackArguments {
  std::string input;
  std::string output;
};

void run_unpack(const UnpackArguments& arguments) {
  require_writable(arguments.output);
  const Case contents = read_case(arguments.input);
  write_scene_section(arguments.output, contents.section ? &*contents.section : nullptr);
  write_scene(arguments.output, contents.scene);
}

}  // namespace

void add_unpack_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("unpack", "Make a scene (PLY, JSON and section) of a case");
  const auto arguments = std::make_shared<UnpackArguments>();
  command->add_option("case", arguments->input, "Case (.sog)")->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "Scene to write (.ply; .json and .section.zip beside it)")
      ->required()
      ->check(ends_in({".ply"}));
  command->footer("Example: clipgs unpack case.sog -o scene.ply");
  command->callback([arguments] { run_unpack(*arguments); });
}

}  // namespace clipgs
