#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "splat/rasterizer.h"
#include "train/uniaxial_model.h"

namespace clipgs {

/// Which parts of the neural model are learnt, and how.
struct UniaxialOptions {
  Truncation truncation = Truncation::kLearned;
  bool adjust = true;  ///< with the adaptive adjustment model
  AdjustmentOptions adjustment;
  float coarse_share = 0.4f;  ///< of the steps before the adjustment acts

  bool operator==(const UniaxialOptions&) const = default;
};

/// The part of a training run that learns truncation and adjustment: stands between the Gaussians
/// and the rasterizer.
class UniaxialLearner {
 public:
  static constexpr float kThresholdRate = 0.05f;  ///< of the temperature
  static constexpr float kWeightRate = 3e-4f;

  /// `normal`: of every plane, towards the kept side. `extent`: of the visible matter along it, mm.
  UniaxialLearner(const UniaxialOptions& options, const Vec3& normal, const Sphere& sphere,
                  float extent, const Gaussians& gaussians, std::uint64_t seed);

  /// As of the last `forward`.
  const UniaxialParameters& parameters() const { return parameters_; }

  /// The Gaussians to draw for the plane at `offset` (none: uncut).
  const Gaussians& forward(const Gaussians& gaussians, std::optional<float> offset);

  /// Given ∂L/∂image of what `rasterizer` drew of the last `forward`, writes the Gaussians'
  /// gradients; see reached().
  void backward(Rasterizer& rasterizer, const Image& image_gradient, Gaussians& gradients);
  /// Ascending indices of the Gaussians whose gradient the last `backward` wrote.
  const std::vector<std::uint32_t>& reached() const { return reached_; }

  /// Moves thresholds and weights after `backward`; `decay` scales their rates.
  void step(float decay);
  /// Lets the adjustment act from now on, if the options have one.
  void start_adjusting();

  /// Gaussians targets[k] became copies of sources[k], and new ones may have been added.
  void copied(const std::vector<std::uint32_t>& targets, const std::vector<std::uint32_t>& sources);

  /// Everything that the next step depends on, as numbers, for a checkpoint.
  std::vector<float> save() const;
  /// Restores it for `size` Gaussians; false if the numbers are not of such a learner, or of one
  /// with other options.
  bool load(const std::vector<float>& numbers, size_t size);

 private:
  /// Adam of a list of numbers; each counts its own updates.
  struct Moments {
    std::vector<float> first, second, updates;
    void resize(size_t size);
    void reset(size_t i);
    float move(size_t i, float gradient, float rate);  ///< what to add to number `i`
  };

  void place_thresholds(const Gaussians& gaussians);

  UniaxialOptions options_;
  UniaxialParameters parameters_;
  // What is learnt of each threshold: mm beyond the centre. A Gaussian that moves, as all do early
  // on, takes its threshold along; but its centre learns nothing from the truncation.
  std::vector<float> beyond_center_;
  std::optional<Adjustment> waiting_;  // the adjustment, until it acts
  Moments threshold_moments_;
  Moments weight_moments_;

  std::optional<float> offset_;
  UniaxialState state_;
  Gaussians state_gradients_;
  UniaxialGradients gradients_;
  std::vector<std::uint32_t> reached_;
};

}  // namespace clipgs
