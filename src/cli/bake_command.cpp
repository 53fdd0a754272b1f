#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/section_step.h"

#include "asset/section_file.h"
#include "bake/state_folder.h"
#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/file.h"
#include "core/json_reader.h"
#include "core/progress.h"
#include "splat/scene_file.h"
#include "train/model_file.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct BakeArguments {
  std::string model;
  std::string from_states;
  std::string planes;
  std::string output;
  std::string export_states;
  int states = kDefaultStates;
  float slab_depth = 0;
  bool json = false;
};

BakeProgress progress_bar(const char* label) {
  const auto bar = std::make_shared<std::unique_ptr<Progress>>();
  return [bar, label](size_t done, size_t total) {
    if (!*bar) {
      *bar = std::make_unique<Progress>(label, total);
    }
    (*bar)->update(done);
  };
}

BakedScene bake_model(const BakeArguments& arguments) {
  const UniaxialModel model = read_model(arguments.model);
  if (!arguments.export_states.empty()) {
    export_states(model, arguments.states, arguments.export_states, progress_bar("export"));
  }
  return bake(model, arguments.states, arguments.slab_depth, progress_bar("bake"));
}

fs::path planes_of(const BakeArguments& arguments) {
  return arguments.planes.empty() ? fs::path(arguments.from_states) / kPlanesFile
                                  : fs::path(arguments.planes);
}

BakedScene bake_folder(const BakeArguments& arguments) {
  return bake_states(arguments.from_states, planes_of(arguments), progress_bar("bake"));
}

Json to_json(const BakedScene& baked) {
  const BakeStatistics& s = baked.statistics;
  Json states = Json::array();
  for (size_t k = 0; k < s.states.size(); ++k) {
    states.push_back(
        {{"position_mm", json_number(baked.scene.states.position(static_cast<int>(k)))},
         {"shown", s.states[k].shown},
         {"in_slab", s.states[k].in_slab},
         {"from_slab", s.states[k].from_slab}});
  }
  return {{"primitives", s.primitives},
          {"kept", s.kept()},
          {"from_slab", s.from_slab},
          {"from_nearest", s.from_nearest},
          {"from_uncut", s.from_uncut},
          {"bytes",
           {{"raw", s.raw_bytes},
            {"shared_sh", s.shared_sh_bytes},
            {"slabs", s.slab_bytes},
            {"consolidated", s.consolidated_bytes}}},
          {"states", std::move(states)}};
}

void print_summary(const BakeArguments& arguments, const BakeStatistics& s) {
  const auto megabytes = [](std::uintmax_t bytes) { return static_cast<double>(bytes) / 1e6; };
  fmt::print("{}: {} of {} Gaussians in {} states\n", arguments.output, s.kept(), s.primitives,
             s.states.size());
  fmt::print("  from their slab {}, the nearest state {}, the uncut scene {}\n", s.from_slab,
             s.from_nearest, s.from_uncut);
  fmt::print("  raw states {:.1f} MB, shared SH {:.1f} MB, slabs {:.1f} MB, one scene {:.1f} MB\n",
             megabytes(s.raw_bytes), megabytes(s.shared_sh_bytes), megabytes(s.slab_bytes),
             megabytes(s.consolidated_bytes));
}

/// The model's section, or none, beside the scene.
void hand_on_section(const BakeArguments& arguments) {
  const fs::path file = section_path(arguments.model);
  if (arguments.model.empty() || !fs::exists(file)) {
    write_scene_section(arguments.output, nullptr);
    return;
  }
  const Section section = read_section(file);
  write_scene_section(arguments.output, &section);
}

/// Throws if the scene, or the JSON beside it, would be written over what it is made of.
void require_apart(const BakeArguments& arguments) {
  std::error_code absent;
  if (fs::equivalent(arguments.output, arguments.model, absent)) {
    throw CLI::ValidationError("--output", "the scene would replace the model");
  }
  const fs::path sidecar = fs::path(arguments.output).replace_extension(".json");
  if (arguments.model.empty() && fs::equivalent(sidecar, planes_of(arguments), absent)) {
    throw CLI::ValidationError("--output", "the JSON beside the scene would replace the planes");
  }
}

void run_bake(const BakeArguments& arguments) {
  if (arguments.model.empty() == arguments.from_states.empty()) {
    throw CLI::ValidationError("bake", "give either a MODEL or --from-states");
  }
  require_apart(arguments);
  require_writable(arguments.output);
  const BakedScene baked = arguments.model.empty() ? bake_folder(arguments) : bake_model(arguments);
  hand_on_section(arguments);
  write_scene(arguments.output, baked.scene);
  if (arguments.json) {
    fmt::print("{}\n", to_json(baked).dump(2));
  } else {
    print_summary(arguments, baked.statistics);
  }
}

}  // namespace

void add_bake_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("bake", "Make one scene with layers of a model's plane states");
  const auto arguments = std::make_shared<BakeArguments>();
  command->add_option("model", arguments->model, "Uniaxial model (.ply, with its .json beside it)");
  command
      ->add_option("-o,--output", arguments->output,
                   "Scene to write (.ply; .json and .section.zip beside it)")
      ->required()
      ->check(ends_in({".ply"}));
  CLI::Option* const states =
      command->add_option("--states", arguments->states, "Plane positions along the axis")
          ->check(CLI::Range(kMinStates, kMaxStates))
          ->capture_default_str();
  CLI::Option* const depth =
      command
          ->add_option(
              "--slab-depth", arguments->slab_depth,
              "Share of the extent below a state's plane at which its slab begins (0: at "
              "the plane, as in the paper; the adjustment's window: what no plane changes)")
          ->check(CLI::Range(0.0, 1.0))
          ->capture_default_str();
  CLI::Option* const exported = command->add_option(
      "--export-states", arguments->export_states,
      "Folder to write every state to as well, as 3DGS PLYs with a planes.json (gigabytes)");
  CLI::Option* const from = command
                                ->add_option("--from-states", arguments->from_states,
                                             "Bake the PLYs of this folder instead of a model")
                                ->excludes(states)
                                ->excludes(depth)
                                ->excludes(exported);
  command
      ->add_option("--planes", arguments->planes,
                   "Planes of the states in that folder (default: its planes.json)")
      ->needs(from);
  command->add_flag("--json", arguments->json, "Print what was kept and its bytes as JSON");
  command->footer(
      "Example: clipgs bake model.ply -o scene.ply --states 200\n"
      "         clipgs bake --from-states states/ -o scene.ply");
  command->callback([arguments] { run_bake(*arguments); });
}

}  // namespace clipgs
