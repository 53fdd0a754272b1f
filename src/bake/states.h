#pragma once

#include <cmath>

#include "splat/scene.h"
#include "train/uniaxial_model.h"

namespace clipgs {

constexpr int kMinStates = 2;

/// Cuts the matter's extent along the axis into `count` equal steps, one state each. A state's
/// plane is the face of its step towards what it removes, so that the step is its slab: the slabs
/// lie side by side and fill the extent. Throws Error if the model's normal is not ± its axis, if
/// its extent is empty, or if `count` is not kMinStates to kMaxStates.
PlaneStates choose_states(const UniaxialModel& model, int count);

/// Whether a centre at `distance` mm from a state's plane, positive on the kept side, lies in the
/// state's slab: [0, spacing). That side alone, because the state shows nothing of the other.
inline bool in_slab(const PlaneStates& states, float distance) {
  return distance >= 0 && distance < states.spacing;
}

/// How far, mm, such a centre is from the middle of the slab. It orders centres by how central they
/// lie in a slab and, outside of slabs, by how far they lie from one.
inline float off_slab(const PlaneStates& states, float distance) {
  return std::abs(distance - 0.5f * states.spacing);
}

}  // namespace clipgs
