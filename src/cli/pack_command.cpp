#include <memory>
#include <string>

#include "pipeline/case_step.h"

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/section_options.h"
#include "core/file.h"

namespace clipgs {

namespace {

struct PackArguments {
  std::string scene;
  std::string output;
  std::string title;
  SectionChoice section;
};

void run_pack(const PackArguments& arguments) {
  require_writable(arguments.output);
  Case contents = load_case(arguments.scene);
  if (!arguments.title.empty()) {
    contents.scene.title = arguments.title;
  }
  if (arguments.section.none) {
    contents.section.reset();
  } else if (contents.section) {
    contents.section = resize_section(*contents.section, arguments.section.size);
  }
  write_finished_case(arguments.output, contents, arguments.section.coding);
}

}  // namespace

void add_pack_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("pack", "Make a case of a scene");
  const auto arguments = std::make_shared<PackArguments>();
  command
      ->add_option("scene", arguments->scene,
                   "Scene (.ply, with its .json and, perhaps, .section.zip beside it)")
      ->required();
  command->add_option("-o,--output", arguments->output, "Case to write (.sog)")
      ->required()
      ->check(ends_in({".sog"}));
  command->add_option("--title", arguments->title, "Title of the case (default: the scene's)");
  add_section_options(*command, arguments->section);
  add_section_coding(*command, arguments->section);
  command->footer("Example: clipgs pack scene.ply -o case.sog --title \"Chest, bone\"");
  command->callback([arguments] { run_pack(*arguments); });
}

}  // namespace clipgs
