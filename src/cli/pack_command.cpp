#include <fmt/format.h>
#include <memory>
#include <string>

#include "asset/case.h"
#include "cli/commands.h"
#include "core/file.h"
#include "splat/scene_file.h"

namespace clipgs {

namespace {

struct PackArguments {
  std::string scene;
  std::string output;
  std::string title;
};

void run_pack(const PackArguments& arguments) {
  require_writable(arguments.output);
  Scene scene = read_scene(arguments.scene);
  if (!arguments.title.empty()) {
    scene.title = arguments.title;
  }
  const Image thumbnail = make_thumbnail(scene);
  const Bytes bytes = encode_case(scene, &thumbnail);
  write_file(arguments.output, bytes.data(), bytes.size());
  fmt::print("{}: {} Gaussians, {:.2f} MB\n", arguments.output, scene.gaussians.size(),
             static_cast<double>(bytes.size()) / 1e6);
}

}  // namespace

void add_pack_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("pack", "Make a case of a scene");
  const auto arguments = std::make_shared<PackArguments>();
  command->add_option("scene", arguments->scene, "Scene (.ply, with its .json beside it)")
      ->required();
  command->add_option("-o,--output", arguments->output, "Case to write (.sog)")->required();
  command->add_option("--title", arguments->title, "Title of the case (default: the scene's)");
  command->footer("Example: clipgs pack scene.ply -o case.sog --title \"Chest, bone\"");
  command->callback([arguments] { run_pack(*arguments); });
}

}  // namespace clipgs
