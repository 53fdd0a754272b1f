#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "cinema/dataset.h"
#include "core/claim.h"
#include "section/section.h"
#include "splat/rasterizer.h"
#include "splat/scene.h"
#include "train/adam.h"
#include "train/loss.h"
#include "train/uniaxial_learner.h"

namespace clipgs {

/// How a scene is trained.
struct TrainOptions {
  size_t budget = 100000;  ///< Gaussians at most
  size_t start = 100000;   ///< Gaussians to start from, at most the budget
  size_t steps = 20000;
  int sh_degree = 1;
  std::uint64_t seed = 1;
  ClipOperator clip = ClipOperator::kExact;
  LossWeights loss;
  float mean_rate = 2e-3f;         ///< of the scene's extent, decayed to 1 % over the steps
  float gain_rate = 2e-3f;         ///< of the face gain's coefficients
  float rate_decay = 0.1f;         ///< the other rates end at this share of themselves
  float coarse_share = 0.2f;       ///< of the steps run at half resolution
  float overdraw_penalty = 5e-5f;  ///< loss for each fragment a pixel (splat/overdraw.h)
  float least_pixels = 0.2f;       ///< a Gaussian that covers less of a picture is dead
  size_t relocate_every = 100;     ///< steps between relocations and growth
  float relocate_until = 0.8f;     ///< share of the steps after which the cloud stays as it is
  size_t idle_steps = 1000;  ///< with a section: a Gaussian that no picture needed for as long
                             ///< is dead
  /// Learns a uniaxial model (ClipGS) instead of an explicit scene: from the uncut frames and the
  /// axis planes that keep the side that most of them keep. `clip` is of no use then.
  std::optional<UniaxialOptions> uniaxial;
};

/// Options for going on with a scene that is almost right: small steps, no coarse pictures, and a
/// budget of whatever the scene has.
TrainOptions refine_options();

/// Fits Gaussians to the training frames of a dataset. Everything random is drawn from (seed,
/// step), so that a run that was interrupted and resumed ends with the same bytes as one that was
/// not.
class Trainer {
 public:
  /// Loads the training frames (kept in memory, 4 bytes a pixel, as much again where a face is
  /// seen) and the seed points. With a `section`, which may be null, its faces lie in front of the
  /// splats: these then need to show outer and inner surfaces only. `start`: what to go on from,
  /// instead of the seed points (its SH degree counts then, and its size if that is above the
  /// budget). Throws Error.
  Trainer(const Dataset& dataset, const TrainOptions& options, const Section* section = nullptr,
          const Scene* start = nullptr);

  /// One step: draw a training frame, compare, move. Returns the loss.
  double step();
  size_t steps_done() const { return step_; }
  const Gaussians& gaussians() const { return gaussians_; }
  const FaceGain& face_gain() const { return gain_.value; }
  /// Null if the options have no uniaxial model.
  const UniaxialParameters* uniaxial() const {
    return uniaxial_ ? &uniaxial_->parameters() : nullptr;
  }

  /// Writes all that the next step depends on, atomically. Throws Error.
  void save_checkpoint(const std::filesystem::path& path);
  /// Restores it; false if there is no such file. Throws Error if it is corrupt, or says what is
  /// otherwise if it is of a run with other settings, other pictures or another start.
  bool load_checkpoint(const std::filesystem::path& path);

 private:
  struct View {
    Camera camera;
    std::optional<Plane> plane;
    std::vector<std::uint8_t> rgba;   // display sRGB, premultiplied
    std::vector<std::uint8_t> faces;  // the same, or empty
  };

  void load_views(const Dataset& dataset, const std::vector<const Frame*>& frames,
                  const Section* section);
  std::string digest_of_views() const;
  std::string digest_of_start(const Dataset& dataset) const;
  const View& next_view();
  const Image& draw(const View& view, const Camera& camera);
  void backward();
  const std::vector<std::uint32_t>& reached() const;
  void learn_gain(const View& view, float rate);
  void note_reached();
  void retire_useless();
  void add_overdraw_penalty();
  void densify();

  TrainOptions options_;
  Claim claim_;      // what the result of the run depends on
  float extent_;     // mm
  float pixel_ = 0;  // mm, of a picture's pixel
  std::vector<View> views_;
  std::vector<std::uint32_t> order_;  // of the current epoch
  size_t step_ = 0;
  Gaussians gaussians_;
  Gaussians gradients_;
  Adam adam_;
  bool has_section_ = false;
  /// The gain of cut faces, and Adam's moments of it.
  struct LearntGain {
    FaceGain value, first, second;
    float updates = 0;
  };
  LearntGain gain_;
  std::vector<std::uint32_t> last_reached_;  // step, of each Gaussian
  std::vector<float> need_;                  // of each Gaussian, see relocate_dead()
  std::optional<UniaxialLearner> uniaxial_;
  Rasterizer rasterizer_;
  ImageLoss loss_;
  Image target_;  // premultiplied
  Image front_;   // the same; what the section shows
  Image image_gradient_;
};

/// Is given a scene on its way (Scene::trained says how far), when it has become worth looking at.
using SceneWatcher = std::function<void(const Scene&)>;

/// Trains from start to finish, or on from `checkpoint` if that file is there; writes it every few
/// minutes (pass an empty path for none), and shows progress. Throws Error.
Scene train(const Dataset& dataset, const TrainOptions& options,
            const std::filesystem::path& checkpoint, const Section* section = nullptr,
            const SceneWatcher& watch = {});

/// The same for a uniaxial model; `options.uniaxial` says which.
UniaxialModel train_model(const Dataset& dataset, const TrainOptions& options,
                          const std::filesystem::path& checkpoint,
                          const Section* section = nullptr);

/// Tunes the Gaussians of `scene` against all training frames, with the clip in the loop
/// (method.md §11); `options.budget`, `start` and `sh_degree` are the scene's. Layers, if it has
/// any, follow the centres.
Scene refine(const Scene& scene, const Dataset& dataset, const TrainOptions& options,
             const std::filesystem::path& checkpoint, const Section* section = nullptr);

/// The scene of a dataset without its Gaussians.
Scene scene_of(const Dataset& dataset);

}  // namespace clipgs
