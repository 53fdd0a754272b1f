#include "bake/state_folder.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <optional>

#include "bake/planes_file.h"
#include "core/error.h"
#include "core/file.h"
#include "core/parallel.h"
#include "splat/ply.h"
#include "splat/similarity.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr size_t kStateGrain = 4096;
constexpr float kHiddenLogit = -20;      // an opacity of 2e-9
constexpr float kShTolerance = 1e-4f;    // between states of one Gaussian
constexpr std::uintmax_t kSpare = 4096;  // bytes of a file beyond its splats
constexpr const char* kUncutFile = "uncut.ply";

std::string describe(const Gaussians& g) {
  return fmt::format("{} splats of SH degree {}{}", g.size(), g.sh_degree(),
                     g.has_face_colors() ? " with face colours" : "");
}

/// All Gaussians of the model, as the state has them.
void spread(const UniaxialState& state, const Gaussians& model, Gaussians& all) {
  std::copy_n(model.data().begin(), Gaussians::kOpacity * model.size(), all.data().begin());
  std::fill_n(all.plane(Gaussians::kOpacity), all.size(), kHiddenLogit);
  for (int p = 0; p <= Gaussians::kOpacity; ++p) {
    for (size_t n = 0; n < state.ids.size(); ++n) {
      all.plane(p)[state.ids[n]] = state.gaussians.plane(p)[n];
    }
  }
}

/// Reads the PLYs of a folder's states into world space and collects what they share.
class StateReader {
 public:
  StateReader(fs::path folder, const PlanesFile& planes)
      : folder_(std::move(folder)), planes_(planes) {}

  void require_files(const fs::path& planes) const {
    std::vector<std::string> files = planes_.files;
    if (!planes_.uncut.empty()) {
      files.push_back(planes_.uncut);
    }
    for (const std::string& file : files) {
      if (!fs::exists(folder_ / file)) {
        throw Error("{}: is missing, but {} lists it; export the states again",
                    (folder_ / file).string(), planes.string());
      }
    }
  }

  Gaussians read(const std::string& file) {
    const fs::path path = folder_ / file;
    Gaussians state = transform(read_ply(path), planes_.world);
    if (known_.empty()) {
      first_file_ = file;
      common_ = state.like(state.size());
      std::fill_n(common_.plane(Gaussians::kOpacity), common_.size(), kHiddenLogit);
      known_.assign(state.size(), 0);
    }
    if (state.size() != common_.size() || !state.is_like(common_)) {
      throw Error("{}: has {}, {} has {}; all states must be of one model", path.string(),
                  describe(state), first_file_, describe(common_));
    }
    collect(state, path);
    return state;
  }

  /// Of each Gaussian that was seen: as the first state has it that shows it.
  Gaussians& common() { return common_; }

 private:
  void collect(const Gaussians& state, const fs::path& path) {
    std::vector<std::uint8_t> differs((state.size() + kStateGrain - 1) / kStateGrain, 0);
    parallel_for(state.size(), kStateGrain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        if (state.plane(Gaussians::kOpacity)[i] < kVisibleLogit) {
          continue;
        }
        for (int p = known_[i] != 0 ? kExplicitPlanes : 0; p < state.planes(); ++p) {
          if (known_[i] == 0) {
            common_.plane(p)[i] = state.plane(p)[i];
          } else if (std::abs(common_.plane(p)[i] - state.plane(p)[i]) > kShTolerance) {
            differs[begin / kStateGrain] = 1;
          }
        }
        known_[i] = 1;
      }
    });
    if (!warned_ && std::ranges::find(differs, 1) != differs.end()) {
      warned_ = true;
      warn(path.string() +
           ": SH above order 0 differ from those of states before it; the first state's are taken");
    }
  }

  fs::path folder_;
  const PlanesFile& planes_;
  std::string first_file_;
  Gaussians common_;
  std::vector<std::uint8_t> known_;  // of each Gaussian: whether a state has shown it
  bool warned_ = false;
};

/// Finds from the Gaussians what planes.json does not say.
void measure(const PlanesFile& planes, Scene& scene) {
  const Gaussians& g = scene.gaussians;
  if (g.size() == 0) {
    throw Error("no state shows a splat: opacities are below 1/255; check how they were exported");
  }
  Box box;
  Vec2 extent(glm::dot(scene.axis, g.mean(0)));
  for (size_t i = 0; i < g.size(); ++i) {
    box.add(g.mean(i));
    const float position = glm::dot(scene.axis, g.mean(i));
    extent = {std::min(extent.x, position), std::max(extent.y, position)};
  }
  if (!planes.has_bounds) {
    scene.bounds = box;
  }
  if (!planes.has_extent) {
    scene.extent = extent;
  }
  if (!planes.has_sphere) {
    scene.sphere = {box.center(), 0};
    for (size_t i = 0; i < g.size(); ++i) {
      scene.sphere.radius =
          std::max(scene.sphere.radius, glm::distance(g.mean(i), scene.sphere.center));
    }
  }
}

}  // namespace

void export_states(const UniaxialModel& model, int state_count, const fs::path& folder,
                   const BakeProgress& progress) {
  const Gaussians& gaussians = model.scene.gaussians;
  PlanesFile planes;
  planes.scene = model.scene;
  planes.scene.states = choose_states(model, state_count);
  planes.world = scene_to_world();
  planes.uncut = kUncutFile;
  const Similarity to_scene = planes.world.inverse();
  create_folder(folder);
  const std::uintmax_t file_bytes =
      gaussians.size() * ply_splat_bytes(gaussians.sh_degree()) + kSpare;
  require_free_space(folder, (static_cast<std::uintmax_t>(state_count) + 1) * file_bytes);
  fs::remove(folder / kPlanesFile);  // it comes last: where it is, the folder is whole

  UniaxialState state;
  Gaussians all = gaussians;
  for (int k = 0; k < state_count; ++k) {
    const PlaneStates& states = planes.scene.states;
    make_state(gaussians, model.parameters,
               states.plane(planes.scene.axis, states.position(k)).offset, state);
    spread(state, gaussians, all);
    planes.files.push_back(fmt::format("state_{:03}.ply", k));
    write_ply(folder / planes.files.back(), transform(all, to_scene));
    if (progress) {
      progress(static_cast<size_t>(k) + 1, static_cast<size_t>(state_count));
    }
  }
  write_ply(folder / kUncutFile, transform(gaussians, to_scene));
  write_text(folder / kPlanesFile, planes_to_json(planes).dump(1) + "\n");
}

BakedScene bake_states(const fs::path& folder, const fs::path& planes_path,
                       const BakeProgress& progress) {
  const PlanesFile planes = read_planes(planes_path);
  StateReader reader(folder, planes);
  reader.require_files(planes_path);
  std::optional<Consolidator> consolidator;
  std::vector<std::uint32_t> ids;
  for (int k = 0; k < planes.scene.states.count; ++k) {
    const Gaussians state = reader.read(planes.files[static_cast<size_t>(k)]);
    if (!consolidator) {
      consolidator.emplace(state.size(), planes.scene.axis, planes.scene.states);
      ids.resize(state.size());
      std::iota(ids.begin(), ids.end(), 0U);
    }
    consolidator->add(k, state, ids);
    if (progress) {
      progress(static_cast<size_t>(k) + 1, planes.files.size());
    }
  }
  if (!planes.uncut.empty()) {
    reader.read(planes.uncut);
  }
  Scene uncut = planes.scene;
  uncut.gaussians = std::move(reader.common());
  BakedScene result = consolidator->finish(std::move(uncut));
  measure(planes, result.scene);
  return result;
}

}  // namespace clipgs
