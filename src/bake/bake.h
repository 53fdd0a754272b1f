#pragma once

#include <functional>

#include "bake/consolidate.h"

namespace clipgs {

/// Called with the number of states that are done, of how many.
using BakeProgress = std::function<void(size_t done, size_t total)>;

/// Makes one explicit scene with states and layers of a uniaxial model: its states (choose_states)
/// one after the other, through a Consolidator. `slab_depth`: where a state's slab begins below its
/// plane, as a share of the extent along the axis; 0: at the plane, as in the paper. Throws Error.
BakedScene bake(const UniaxialModel& model, int state_count, float slab_depth = 0,
                const BakeProgress& progress = {});

}  // namespace clipgs
