#pragma once

#include <cstdint>
#include <vector>

#include "core/random.h"
#include "splat/gaussians.h"
#include "train/adam.h"

namespace clipgs {

/// Densification, after 3DGS-MCMC (Kheradmand et al. 2024): those that have died are moved to where
/// Gaussians are needed, new ones are added up to a budget, and faint ones wander. Memory is
/// bounded by the budget. Need and splitting are ours (method.md §5).
struct Densification {
  static constexpr float kDeadOpacity = 0.005f;
  static constexpr size_t kGrowthDivisor = 20;  ///< one call grows the cloud by a twentieth
  static constexpr float kNoiseRate = 5e5f;     ///< of `add_noise`, relative to the means' rate
  /// Of one Gaussian in a call: its rest has shrunk to a fifteenth, and more of them would be dust.
  static constexpr int kMostSplits = 8;
  static constexpr float kSplitOffset = 0.7f;   ///< of halves from the whole, in its deviations
  static constexpr float kSplitOpacity = 0.8f;  ///< of a half, relative to the whole's
};

/// Gaussian targets[k] became half of sources[k].
struct Copies {
  std::vector<std::uint32_t> targets, sources;
};

/// Splits a living Gaussian for every dead one, which becomes its other half; where one is drawn
/// more than kMostSplits times the dead wait for the next call. They are drawn with probability ∝
/// opacity·need (≥ 0, of each Gaussian: how much the loss pulls at it); a need is split too.
/// Returns which moved where.
Copies relocate_dead(Gaussians& gaussians, Adam& adam, std::vector<float>& need, Rng rng);

/// Adds halves of living Gaussians the same way, at most to `budget`. Returns which.
Copies grow(Gaussians& gaussians, Adam& adam, std::vector<float>& need, size_t budget, Rng rng);

/// Adds noise shaped by each Gaussian's covariance to its mean, fading out as opacity rises.
/// `rate` is the means' current relative learning rate divided by the scene's extent, 1/mm (a
/// covariance, mm², times it is a step in mm).
void add_noise(Gaussians& gaussians, float rate, std::uint64_t seed, std::uint64_t step);

}  // namespace clipgs
