#pragma once

#include <algorithm>

namespace clipgs {

/// Where values are steep, and matter looks as a boundary does.
struct SteepRange {
  float from = 0;  ///< ‖∇v‖ up to which matter looks as its value alone says, value units per mm
  float to = 1;    ///< ‖∇v‖ from which it looks as a boundary does

  /// How much of the boundary's look matter has where ‖∇v‖ = `steepness`: 0…1, linear in between.
  float share(float steepness) const {
    return std::clamp((steepness - from) / (to - from), 0.0f, 1.0f);
  }
};

}  // namespace clipgs
