#pragma once

#include <cstdint>
#include <vector>

#include "core/random.h"
#include "splat/gaussians.h"
#include "train/adam.h"

namespace clipgs {

/// Densification after 3DGS-MCMC (Kheradmand et al. 2024): Gaussians are samples of the scene,
/// those that have died are moved onto living ones, new ones are added up to a budget, and faint
/// ones wander. Memory is bounded by the budget.
struct Densification {
  static constexpr float kDeadOpacity = 0.005f;
  static constexpr size_t kGrowthDivisor = 20;  ///< one call grows the cloud by a twentieth
  static constexpr float kNoiseRate = 5e5f;     ///< of `add_noise`, relative to the means' rate
};

/// Gaussian targets[k] became a copy of sources[k].
struct Copies {
  std::vector<std::uint32_t> targets, sources;
};

/// Moves every dead Gaussian onto a living one, drawn with probability ∝ opacity; source and copies
/// share the opacity and shrink so that the picture stays the same. Returns which moved where.
Copies relocate_dead(Gaussians& gaussians, Adam& adam, Rng rng);

/// Adds copies of living Gaussians the same way, at most to `budget`. Returns which.
Copies grow(Gaussians& gaussians, Adam& adam, size_t budget, Rng rng);

/// Adds noise shaped by each Gaussian's covariance to its mean, fading out as opacity rises.
/// `rate` is the means' current relative learning rate divided by the scene's extent, 1/mm (a
/// covariance, mm², times it is a step in mm).
void add_noise(Gaussians& gaussians, float rate, std::uint64_t seed, std::uint64_t step);

}  // namespace clipgs
