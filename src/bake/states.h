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

/// The part of the kept side of a state's plane that is taken from it: [depth, depth + spacing) mm
/// from the plane. That side alone, because the state shows nothing of the other.
struct Slab {
  float spacing;    ///< mm, of the states
  float depth = 0;  ///< mm; 0: at the plane, as in the paper

  /// Whether a centre at `distance` mm from the plane, positive on the kept side, lies in it.
  bool holds(float distance) const { return distance >= depth && distance < depth + spacing; }
  /// How far, mm, such a centre is from the slab's middle. It orders centres by how central they
  /// lie in a slab and, outside of slabs, by how far they lie from one.
  float off_middle(float distance) const { return std::abs(distance - depth - 0.5f * spacing); }
};

}  // namespace clipgs
