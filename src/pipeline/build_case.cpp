#include "pipeline/build_case.h"

#include <algorithm>
#include <fmt/format.h>
#include <future>
#include <utility>

#include "pipeline/case_step.h"
#include "pipeline/instant_case.h"

#include "asset/section_file.h"
#include "bake/bake.h"
#include "cinema/dataset_claim.h"
#include "core/claim.h"
#include "core/digest.h"
#include "core/file.h"
#include "splat/scene_file.h"
#include "train/model_file.h"
#include "train/training_claim.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

// Raised whenever the same model gives another scene with layers.
constexpr int kBakingRevision = 1;
// Raised whenever the same volume has another instant case.
constexpr int kInstantRevision = 2;
// The same of the one that has the finished case's section.
constexpr int kPlacedRevision = 2;
// The same of a scene's case.
constexpr int kCaseRevision = 1;

void say_step(int step, const std::string& what) { fmt::print(stderr, "[{}/4] {}\n", step, what); }

DatasetOptions dataset_options(const BuildOptions& build) {
  DatasetOptions options = build.pictures;
  options.seed_points = std::max(options.seed_points, build.training.budget);
  options.choose_views = !build.section.none;
  options.one_sided = build.papers_way;
  options.near_share = usual_near_share(options);
  return options;
}

/// What a case depends on in which nothing is learnt.
Claim unlearnt_claim(const char* step, int revision, const Volume& volume, const Preset& preset,
                     const BuildOptions& build) {
  Claim claim = claim_of_step(step, revision);
  claim["pictures"] = digest_of(claims_of(volume, preset, dataset_options(build)).pictures);
  claim["section_size"] = build.section.none ? 0 : build.section.size;
  claim["title"] = build.title;
  claim["region"] = body_part_name(volume.part);
  return claim;
}

/// Shows what the section alone does, unless that was done. Returns the section, if it was made.
std::optional<Section> show_section(TracedVolume& traced, const Preset& preset,
                                    const BuildOptions& build, const fs::path& work,
                                    const CaseWatcher& show) {
  if (!show || build.section.none || build.papers_way) {
    return std::nullopt;
  }
  const Step step("case of the section", work / "placed",
                  unlearnt_claim("placed", kPlacedRevision, traced.scanned(), preset, build), {});
  if (step.done()) {
    return std::nullopt;
  }
  std::optional<Section> section(
      make_section(traced.traced(), traced.scanned(), preset, {build.section.size}));
  if (std::optional<Case> contents =
          make_placed_case(traced.scanned(), preset, *section, build.title)) {
    show(*std::move(contents));
  }
  step.finish();
  return section;
}

Dataset build_dataset(const Volume& volume, const Preset& preset, const BuildOptions& build,
                      const fs::path& work, const CaseWatcher& show) {
  const DatasetOptions options = dataset_options(build);
  const int tests = 2 * options.test_frames + options.uncut_frames + options.close_frames;
  say_step(2, fmt::format("pictures: {0} training, {1} test and half as many validation, {2}x{2}, "
                          "preset {3}",
                          options.train_frames, tests, options.size, preset.name));
  TracedVolume traced(volume, preset, options.upsample);
  std::optional<Section> section = show_section(traced, preset, build, work, show);
  const Dataset dataset = make_dataset(traced, preset, work / "dataset", options);
  make_dataset_section(traced, preset, dataset, build.section, std::move(section));
  return dataset;
}

/// What training depends on. Without `faces`: not on a section, whether there is one or not.
Claim training_claim(const TrainOptions& options, const Dataset& dataset, const Section* faces) {
  Claim claim = claim_of(options);
  claim["pictures"] = digest_of(read_claim(dataset.folder / "transforms"));
  claim["seed_points"] = digest_of(read_claim(dataset.folder / "points"));
  claim["section"] = faces != nullptr ? digest_of(read_claim(dataset.folder / "section")) : "none";
  return claim;
}

/// NAME.ply and what lies beside it while it is made, and then.
struct SceneFiles {
  explicit SceneFiles(const fs::path& stem)
      : ply(stem.string() + ".ply"),
        json(stem.string() + ".json"),
        checkpoint(stem.string() + ".checkpoint") {}

  std::vector<fs::path> results(const Section* faces) const {
    std::vector<fs::path> files{ply, json};
    if (faces != nullptr) {
      files.push_back(section_path(ply));
    }
    return files;
  }

  fs::path ply, json, checkpoint;
};

void build_explicit(const Dataset& dataset, const BuildOptions& build, const Section* faces,
                    const fs::path& stem, const CaseWatcher& show) {
  const SceneFiles files(stem);
  const Step step("training", stem, training_claim(build.training, dataset, faces),
                  files.results(faces), {files.checkpoint});
  if (!step.done()) {
    const auto show_scene = [&](const Scene& scene) {
      Case contents(scene, faces != nullptr ? std::optional(*faces) : std::nullopt);
      name_case(contents, build.title);
      show(std::move(contents));
    };
    const Scene scene = train(dataset, build.training, files.checkpoint, faces,
                              show ? SceneWatcher(show_scene) : SceneWatcher());
    write_scene_section(files.ply, faces);
    write_scene(files.ply, scene);
    step.finish();
    fs::remove(files.checkpoint);
  }
}

/// The papers' way: a neural model, its states baked into one scene, that refined under any cut.
void build_layered(const Dataset& dataset, const BuildOptions& build, const Section* faces,
                   const fs::path& stem) {
  // Without the section's faces: the model, and each of its states, must be solid.
  TrainOptions learning = build.training;
  learning.steps = std::max<size_t>(1, build.training.steps / 2);
  const UniaxialOptions& uniaxial = learning.uniaxial.emplace();
  const fs::path model_stem = stem.parent_path() / "model";
  const SceneFiles model(model_stem);
  const Step learnt("model", model_stem, training_claim(learning, dataset, nullptr),
                    model.results(nullptr), {model.checkpoint});
  if (!learnt.done()) {
    write_model(model.ply, train_model(dataset, learning, model.checkpoint));
    learnt.finish();
    fs::remove(model.checkpoint);
  }

  TrainOptions refining = refine_options();
  refining.steps = std::max<size_t>(1, build.training.steps - learning.steps);
  refining.seed = build.training.seed;
  Claim claim = training_claim(refining, dataset, faces);
  claim["model"] = digest_of(learnt.claim());
  claim["baking"] = kBakingRevision;
  const SceneFiles scene(stem);
  const Step refined("refinement", stem, claim, scene.results(faces), {scene.checkpoint});
  if (!refined.done()) {
    // Each primitive as it is where no plane is near: refinement cuts by the operator, not by
    // adjusting.
    const float depth = uniaxial.adjustment.window;
    const Scene layered = bake(read_model(model.ply), kDefaultStates, depth).scene;
    const Scene result = refine(layered, dataset, refining, scene.checkpoint, faces);
    write_scene_section(scene.ply, faces);
    write_scene(scene.ply, result);
    refined.finish();
    fs::remove(scene.checkpoint);
  }
}

Case build_scene(const Dataset& dataset, const BuildOptions& build, const fs::path& stem,
                 const CaseWatcher& show) {
  say_step(3, fmt::format("training: {} Gaussians, {} steps", build.training.budget,
                          build.training.steps));
  const std::optional<Section> section = read_dataset_section(dataset);
  const Section* const faces = section ? &*section : nullptr;
  if (build.papers_way) {
    build_layered(dataset, build, faces, stem);
  } else {
    build_explicit(dataset, build, faces, stem, show);
  }
  // Turning into the file's axes and back may round: a build that resumes here must end the same.
  return load_case(SceneFiles(stem).ply);
}

/// Of what is in a file; of none, nothing.
std::string digest_of_file(const fs::path& path) {
  constexpr std::uintmax_t kMost = std::uintmax_t{1} << 30;
  return fs::exists(path) ? Digest().add(read_file(path, kMost)).hex() : std::string();
}

/// The finished case, unless the file holds it.
void write_last(const fs::path& output, const Case& contents, const BuildOptions& options,
                const fs::path& work) {
  const CaseCoding& coding = options.section.coding;
  const VolumeLook& look = contents.scene.look;
  Claim claim = claim_of_step("case", kCaseRevision);
  claim["scene"] = digest_of(read_claim(work / "scene"));
  claim["title"] = options.title;
  claim["look"] = look.title + "\n" + look.description;
  claim["region"] = body_part_name(look.part);
  claim["bytes"] = coding.bytes;
  claim["section_quality"] = coding.section_quality.value_or(0);
  const fs::path written = work / "case.digest";
  const Step step("case", work / "case", claim, {written});
  if (step.done() && read_text(written) == digest_of_file(output)) {
    return;
  }
  write_finished_case(output, contents, coding);
  write_text(written, digest_of_file(output));
  step.finish();
}

/// Writes what is worth looking at while the work goes on, one after the other.
class Showing {
 public:
  Showing(fs::path output, const CaseCoding& asked)
      : output_(std::move(output)), coding_(quick_coding(asked)) {}

  void show(Case contents) {
    wait();
    writing_ = std::async(std::launch::async, [this, shown = std::move(contents)] {
      write_finished_case(output_, shown, coding_);
    });
  }
  /// Throws Error if what was shown last could not be written.
  void wait() {
    if (writing_.valid()) {
      writing_.get();
    }
  }

 private:
  fs::path output_;
  CaseCoding coding_;
  std::future<void> writing_;
};

}  // namespace

void build_instant_first(const Volume& volume, const Preset& preset, const BuildOptions& options,
                         const FolderLock& work, const fs::path& output) {
  require_look_for_section(preset, options.section);
  if (is_finished_case(output)) {
    return;
  }
  const Step step("instant case", work.folder() / "instant",
                  unlearnt_claim("instant", kInstantRevision, volume, preset, options), {});
  if (!step.done() || !fs::exists(output)) {
    build_instant_case(volume, preset, {options.section, options.pictures.upsample, options.title},
                       output);
    step.finish();
  }
}

Case build_contents(Volume volume, const Preset& preset, const BuildOptions& options,
                    const FolderLock& work, const CaseWatcher& show) {
  require_look_for_section(preset, options.section);
  const FolderLock lock(work.folder() / "dataset");  // clipgs dataset may be pointed here, too
  const Dataset dataset =
      build_dataset(std::exchange(volume, {}), preset, options, work.folder(), show);
  Case contents = build_scene(dataset, options, work.folder() / "scene", show);
  name_case(contents, options.title);
  contents.scene.look = dataset.look;  // that of work kept since before scenes had one, too
  return contents;
}

void build_case(Volume volume, const Preset& preset, const BuildOptions& options,
                const FolderLock& work, const fs::path& output) {
  build_instant_first(volume, preset, options, work, output);
  Showing showing(output, options.section.coding);
  CaseWatcher show;
  if (!is_finished_case(output)) {
    show = [&](Case contents) { showing.show(std::move(contents)); };
  }
  const Case contents = build_contents(std::move(volume), preset, options, work, show);
  showing.wait();
  say_step(4, "case");
  write_last(output, contents, options, work.folder());
}

}  // namespace clipgs
