#pragma once

#include <cmath>
#include <string>

namespace clipgs {

/// What a plane removes of a uniaxial model (method.md §9): nothing, Gaussians whose centre it cuts
/// off, or those whose learned threshold it has passed (ClipGS's learnable truncation).
enum class Truncation { kNone, kHard, kLearned };

Truncation parse_truncation(const std::string& name);  ///< throws Error listing the names
const char* truncation_name(Truncation truncation);

/// The truncation's sigmoid has this temperature, as a share of the matter's extent along the axis.
/// ClipGS states none.
constexpr float kTruncationTemperature = 0.01f;

/// Whether a Gaussian of threshold `m` (mm along the plane's normal) is shown by the plane at
/// `offset`: M = 1[sigmoid((m − offset)/τ) > ½].
inline bool is_shown(float m, float offset) { return m > offset; }

/// ∂M/∂m, 1/mm, as the straight-through estimator has it: the sigmoid's derivative in place of the
/// step's. `temperature` τ in mm.
inline float straight_through(float m, float offset, float temperature) {
  const float sigmoid = 1.0f / (1.0f + std::exp(-(m - offset) / temperature));
  return sigmoid * (1 - sigmoid) / temperature;
}

}  // namespace clipgs
