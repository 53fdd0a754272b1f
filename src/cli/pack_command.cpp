#include <memory>
#include <string>

#include "pipeline/case_step.h"

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/section_options.h"
#include "cli/volume_options.h"
#include "core/file.h"

namespace clipgs {

namespace {

struct PackArguments {
  std::string scene;
  std::string output;
  std::string title;
  BodyPart part = BodyPart::kUnknown;
  SectionChoice section;
};

void run_pack(const PackArguments& arguments) {
  require_writable(arguments.output);
  Case contents = load_case(arguments.scene);
  Scene& scene = contents.scene;
  if (arguments.part != BodyPart::kUnknown) {
    scene.look.part = arguments.part;
  }
  if (!arguments.title.empty()) {
    scene.title = arguments.title;
  } else if (scene.title.empty()) {
    scene.title = usual_title(scene.look, scene.preset);
  }
  if (scene.created.empty()) {
    scene.created = today();
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
  add_title_option(*command, arguments->title,
                   "the scene's, else region of the body and look, e.g. \"Head, skin and bone\"");
  add_region_option(*command, arguments->part);
  add_section_options(*command, arguments->section);
  add_section_coding(*command, arguments->section);
  command->footer("Example: clipgs pack scene.ply -o case.sog --title \"Chest, bone\"");
  command->callback([arguments] { run_pack(*arguments); });
}

}  // namespace clipgs
