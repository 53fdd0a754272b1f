#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "bake/bake.h"
#include "cinema/make_dataset.h"
#include "cli/case_step.h"
#include "cli/commands.h"
#include "cli/look_options.h"
#include "cli/section_step.h"
#include "cli/volume_options.h"
#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "splat/scene_file.h"
#include "train/model_file.h"
#include "train/trainer.h"
#include "volume/load.h"
#include "volume/preset.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

/// How much work a build puts in.
struct Quality {
  const char* name;
  int size;  // px, training and test pictures
  int train_frames;
  int test_frames;  // per test split
  int train_spp;
  size_t budget;
  size_t steps;
  int sh_degree;
};

// Many pictures of few samples teach more than few clean ones: every picture shows other planes,
// and noise averages out over them. What limits their number is the memory that training holds them
// in.
constexpr std::array kQualities = {
    Quality{"draft", 192, 600, 8, 4, 40000, 4000, 1},
    Quality{"standard", 256, 2000, 20, 10, 60000, 8000, 2},
    Quality{"high", 512, 3000, 32, 12, 150000, 24000, 2},
};

const Quality& find_quality(const std::string& name) {
  for (const Quality& quality : kQualities) {
    if (name == quality.name) {
      return quality;
    }
  }
  throw CLI::ValidationError("--quality",
                             fmt::format("\"{}\" is not draft, standard or high", name));
}

/// Numbers of the quality that the user wants otherwise; 0 or −1: as the quality says.
struct Overrides {
  int size = 0;
  int train_frames = 0;
  int test_frames = 0;
  size_t budget = 0;
  size_t steps = 0;
  int sh_degree = -1;
};

struct BuildArguments {
  std::string volume;
  std::string output;
  LookArguments look;
  std::string quality = "standard";
  std::string model = "explicit";
  std::string work;
  std::string title;
  std::uint64_t seed = 1;
  LoadOptions loading;
  SectionChoice section;
  bool denoise = false;
  Overrides overrides;
};

Quality chosen_quality(const BuildArguments& arguments) {
  Quality quality = find_quality(arguments.quality);
  const Overrides& o = arguments.overrides;
  quality.size = o.size > 0 ? o.size : quality.size;
  quality.train_frames = o.train_frames > 0 ? o.train_frames : quality.train_frames;
  quality.test_frames = o.test_frames > 0 ? o.test_frames : quality.test_frames;
  quality.budget = o.budget > 0 ? o.budget : quality.budget;
  quality.steps = o.steps > 0 ? o.steps : quality.steps;
  quality.sh_degree = o.sh_degree >= 0 ? o.sh_degree : quality.sh_degree;
  return quality;
}

fs::path work_folder(const BuildArguments& arguments) {
  if (!arguments.work.empty()) {
    return arguments.work;
  }
  return fs::path(arguments.output).replace_extension(".clipgs-work");
}

/// Names, sizes and times of the input's files, so that a changed input is noticed.
std::uint64_t fingerprint(const fs::path& path) {
  const auto of_file = [](const fs::path& file) {
    const auto time = fs::last_write_time(file).time_since_epoch().count();
    return Rng::mix(std::hash<std::string>()(file.filename().string()) ^
                    Rng::mix(fs::file_size(file) ^ Rng::mix(static_cast<std::uint64_t>(time))));
  };
  if (!fs::is_directory(path)) {
    return fs::exists(path) ? of_file(path) : 0;
  }
  std::uint64_t sum = 0;  // order of a folder's entries is not defined
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) {
      sum += of_file(entry.path());
    }
  }
  return sum;
}

/// All that a build's results depend on, for its work folder.
nlohmann::json claim_of(const BuildArguments& arguments, const Quality& quality) {
  const std::optional<Rescale>& hu = arguments.loading.hu;
  return {{"input", fingerprint(arguments.volume)},
          {"preset", arguments.look.preset},
          {"rig", arguments.look.rig},
          {"exposure", arguments.look.exposure},
          {"gradient_opacity", arguments.look.gradient_opacity},
          {"labels", fingerprint(arguments.loading.labels)},
          {"label", arguments.look.labels.looks},
          {"label_table", fingerprint(arguments.look.labels.table)},
          {"size", quality.size},
          {"train_frames", quality.train_frames},
          {"test_frames", quality.test_frames},
          {"train_spp", quality.train_spp},
          {"budget", quality.budget},
          {"steps", quality.steps},
          {"sh_degree", quality.sh_degree},
          {"seed", arguments.seed},
          {"hu", hu ? nlohmann::json{hu->scale, hu->offset} : nlohmann::json()},
          {"series", arguments.loading.series},
          {"frame", arguments.loading.frame},
          {"keep_table", arguments.loading.keep_table},
          {"denoise", arguments.denoise},
          {"model", arguments.model},
          {"section", arguments.section.none ? 0 : arguments.section.size}};
}

constexpr const char* kClaimFile = "build.json";

/// Makes sure that a work folder with results of another build is not mixed with this one's.
void check_work_folder(const fs::path& work, const nlohmann::json& claim) {
  const fs::path file = work / kClaimFile;
  if (fs::exists(file) && nlohmann::json::parse(read_text(file), nullptr, false) != claim) {
    throw Error(
        "{}: holds the work of a build with another input or other options; delete it, or "
        "give this build its own with --work",
        work.string());
  }
}

/// Today, or the day of SOURCE_DATE_EPOCH for builds that must repeat to the byte.
std::string today() {
  const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
  const std::time_t time = epoch != nullptr ? std::strtoll(epoch, nullptr, 10) : std::time(nullptr);
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(time));
}

void say_step(int step, const std::string& what) { fmt::print(stderr, "[{}/4] {}\n", step, what); }

Dataset build_dataset(const BuildArguments& arguments, const Quality& quality,
                      const nlohmann::json& claim, const fs::path& work) {
  const fs::path folder = work / "dataset";
  if (fs::exists(folder / "transforms.json")) {
    const Dataset dataset = load_dataset(folder);
    if (arguments.section.none || read_dataset_section(dataset)) {
      say_step(2, "pictures: done before");
      return dataset;
    }
  }
  const Volume volume = load_volume(arguments.volume, arguments.loading);
  const Preset preset = load_look(arguments.look, volume);
  require_look_for_section(preset, arguments.section);
  // Only now, so that an input that cannot be used leaves nothing behind.
  create_folder(work);
  write_text(work / kClaimFile, claim.dump(1));
  say_step(2, fmt::format("pictures: {} training, {} test, {}x{}, preset {}", quality.train_frames,
                          2 * quality.test_frames, quality.size, quality.size, preset.name));
  DatasetOptions options;
  options.size = quality.size;
  options.train_frames = quality.train_frames;
  options.test_frames = quality.test_frames;
  options.train_spp = quality.train_spp;
  options.seed_points = std::max(options.seed_points, quality.budget);
  options.seed = arguments.seed;
  options.choose_views = !arguments.section.none;
  options.denoise = arguments.denoise;
  options.one_sided = arguments.model == "clipgs";
  const Dataset dataset = make_dataset(volume, preset, folder, options);
  make_dataset_section(volume, preset, dataset, arguments.section);
  return dataset;
}

/// The papers' way: a neural model, its states baked into one scene, that refined under any cut.
/// The model's file, once there, is a finished step.
Scene train_bake_refine(const Dataset& dataset, const TrainOptions& options, const Section* faces,
                        const fs::path& checkpoint) {
  const fs::path model_path = dataset.folder.parent_path() / "model.ply";
  TrainOptions learning = options;
  learning.steps = std::max<size_t>(1, options.steps / 2);
  learning.uniaxial.emplace();
  if (!is_model(model_path)) {
    // Without the section's faces: the model, and each of its states, must be solid.
    const fs::path model_checkpoint = fs::path(model_path).replace_extension(".checkpoint");
    write_model(model_path, train_model(dataset, learning, model_checkpoint));
    fs::remove(model_checkpoint);
  }
  TrainOptions refining = refine_options();
  refining.steps = std::max<size_t>(1, options.steps - learning.steps);
  refining.seed = options.seed;
  // Each primitive as it is where no plane is near: refinement cuts by the operator, not by
  // adjusting.
  const float depth = learning.uniaxial->adjustment.window;
  const Scene layered = bake(read_model(model_path), kDefaultStates, depth).scene;
  return refine(layered, dataset, refining, checkpoint, faces);
}

Case build_scene(const BuildArguments& arguments, const Quality& quality, const Dataset& dataset,
                 const fs::path& path) {
  if (fs::exists(path)) {
    say_step(3, "training: done before");
    return load_case(path);
  }
  say_step(3, fmt::format("training: {} Gaussians, {} steps", quality.budget, quality.steps));
  TrainOptions options;
  options.budget = options.start = quality.budget;
  options.steps = quality.steps;
  options.sh_degree = quality.sh_degree;
  options.seed = arguments.seed;
  fs::path checkpoint = path;
  checkpoint.replace_extension(".checkpoint");
  const std::optional<Section> section = read_dataset_section(dataset);
  const Section* const faces = section ? &*section : nullptr;
  const Scene scene = arguments.model == "clipgs"
                          ? train_bake_refine(dataset, options, faces, checkpoint)
                          : train(dataset, options, checkpoint, faces);
  write_scene_section(path, faces);
  write_scene(path, scene);
  fs::remove(checkpoint);
  // Turning into the file's axes and back may round: a build that resumes here must end the same.
  return load_case(path);
}

void run_build(const BuildArguments& arguments) {
  const Quality quality = chosen_quality(arguments);
  require_writable(arguments.output);
  const fs::path work = work_folder(arguments);
  say_step(1, fmt::format("{}: work is kept in {}", arguments.volume, work.string()));
  if (!fs::exists(arguments.volume)) {
    throw Error(
        "{}: does not exist; give a DICOM folder or .zip, or a NIfTI, NRRD or MetaImage file",
        arguments.volume);
  }
  const nlohmann::json claim = claim_of(arguments, quality);
  check_work_folder(work, claim);
  const Dataset dataset = build_dataset(arguments, quality, claim, work);
  Case contents = build_scene(arguments, quality, dataset, work / "scene.ply");
  Scene& scene = contents.scene;
  say_step(4, "case");
  scene.title = arguments.title.empty() ? scene.preset : arguments.title;
  scene.created = today();
  write_finished_case(arguments.output, contents, arguments.section.coding);
}

}  // namespace

void add_build_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("build", "From a volume to a case: pictures, training, packing");
  const auto arguments = std::make_shared<BuildArguments>();
  command
      ->add_option("volume", arguments->volume,
                   "DICOM (folder, file or .zip), NIfTI, NRRD or MetaImage")
      ->required();
  command->add_option("-o,--output", arguments->output, "Case to write (.sog)")->required();
  add_look_options(*command, arguments->look);
  add_label_options(*command, arguments->look.labels, arguments->loading);
  command->add_option("--quality", arguments->quality, "draft, standard or high")
      ->capture_default_str();
  command
      ->add_option("--model", arguments->model,
                   "explicit: Gaussians trained under cuts of any angle; clipgs: a neural model, "
                   "baked into 200 layers and refined, as the papers have it")
      ->check(CLI::IsMember({"explicit", "clipgs"}))
      ->capture_default_str();
  command->add_option("--work", arguments->work,
                      "Folder for the work in progress (default: OUTPUT.clipgs-work)");
  command->add_option("--title", arguments->title,
                      "Title of the case (default: the preset's name)");
  command->add_option("--seed", arguments->seed, "Seed of everything random")
      ->capture_default_str();
  add_section_options(*command, arguments->section);
  add_section_coding(*command, arguments->section);
  add_volume_options(*command, arguments->loading);
  Overrides& overrides = arguments->overrides;
  command->add_option("--size", overrides.size, "Side of the pictures, px")
      ->check(CLI::Range(32, 4096))
      ->group("Instead of what the quality says");
  command->add_option("--train-frames", overrides.train_frames, "Training pictures")
      ->check(CLI::Range(1, 100000))
      ->group("Instead of what the quality says");
  command->add_option("--test-frames", overrides.test_frames, "Test pictures of each split")
      ->check(CLI::Range(1, 10000))
      ->group("Instead of what the quality says");
  command->add_flag("--denoise", arguments->denoise,
                    "Smooth noise of training pictures away; test pictures stay as traced");
  command->add_option("--budget", overrides.budget, "Gaussians at most")
      ->check(CLI::Range(100, 5000000))
      ->group("Instead of what the quality says");
  command->add_option("--steps", overrides.steps, "Training steps")
      ->check(CLI::Range(1, 10000000))
      ->group("Instead of what the quality says");
  command->add_option("--sh-degree", overrides.sh_degree, "Degree of the colours' view dependence")
      ->check(CLI::Range(0, kMaxShDegree))
      ->group("Instead of what the quality says");
  command->footer(
      "An interrupted build resumes when it is run again. The work folder keeps the pictures for\n"
      "clipgs eval; delete it when you do not need them.\n"
      "Example: clipgs build dicom/ -o case.sog");
  command->callback([arguments] {
    leave_section_to_splats(arguments->loading, arguments->section);
    run_build(*arguments);
  });
}

}  // namespace clipgs
