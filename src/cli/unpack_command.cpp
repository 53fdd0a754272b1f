#include <memory>
#include <string>

#include "asset/case.h"
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
  write_scene(arguments.output, read_case(arguments.input));
}

}  // namespace

void add_unpack_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("unpack", "Make a scene (PLY and JSON) of a case");
  const auto arguments = std::make_shared<UnpackArguments>();
  command->add_option("case", arguments->input, "Case (.sog)")->required();
  command->add_option("-o,--output", arguments->output, "Scene to write (.ply; a .json beside it)")
      ->required();
  command->footer("Example: clipgs unpack case.sog -o scene.ply");
  command->callback([arguments] { run_unpack(*arguments); });
}

}  // namespace clipgs
