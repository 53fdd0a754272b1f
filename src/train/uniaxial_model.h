#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "splat/gaussians.h"
#include "splat/scene.h"
#include "train/adjustment.h"
#include "train/truncation.h"

namespace clipgs {

/// What ClipGS learns beside the Gaussians (method.md §9): which of them a plane of fixed normal
/// shows, and how it changes those near it.
struct UniaxialParameters {
  Vec3 normal{0, 0, -1};  ///< of every plane, towards the kept side
  Truncation truncation = Truncation::kLearned;
  float temperature = 1;          ///< τ of the truncation, mm
  std::vector<float> thresholds;  ///< m of each Gaussian, mm along `normal`
  std::optional<Adjustment> adjustment;
};

/// ClipGS: a scene that a plane of fixed normal cuts.
struct UniaxialModel {
  Scene scene;  ///< its Gaussians are those of the uncut scene
  UniaxialParameters parameters;
};

/// The explicit Gaussians of one plane position. Keeps its buffers between calls.
struct UniaxialState {
  Gaussians gaussians;             ///< shown ones, adjusted
  std::vector<std::uint32_t> ids;  ///< of each: its index in the model, ascending

  // What the adjustment was asked for: indices into `gaussians`, and its inputs.
  std::vector<std::uint32_t> adjusted;
  std::vector<AdjustmentInput> inputs;
};

/// Truncates and adjusts for the plane normal·x = `offset` (mm); none: the uncut scene, in which
/// nothing is hidden or adjusted.
void make_state(const Gaussians& gaussians, const UniaxialParameters& parameters,
                std::optional<float> offset, UniaxialState& state);

/// The loss's gradients of what the neural model learns beside its Gaussians.
struct UniaxialGradients {
  std::vector<float>
      thresholds;              ///< ∂L/∂m of each Gaussian, 1/mm; 0 of those that were not reached
  std::vector<float> weights;  ///< ∂L/∂weights of the adjustment; empty if it did not act
};

/// Chain rule through `make_state`. `state_gradients` is ∂L/∂parameter of the state's Gaussians,
/// defined for those in `reached` (indices into the state). Writes the model's for the same ones
/// into `gradients` and turns `reached` into the model's indices. A hidden Gaussian adds nothing to
/// a picture, however little its opacity changes: below 1/255 it is not drawn. So the truncation is
/// taught by those that are shown.
void state_backward(const UniaxialParameters& parameters, std::optional<float> offset,
                    const UniaxialState& state, const Gaussians& state_gradients,
                    std::vector<std::uint32_t>& reached, Gaussians& gradients,
                    UniaxialGradients& uniaxial);

}  // namespace clipgs
