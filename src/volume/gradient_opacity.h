#pragma once

#include <algorithm>

namespace clipgs {

/// Extinction by the steepness of the values (Levoy 1988): even interiors become transparent, the
/// boundaries between tissues stay.
struct GradientOpacity {
  float from = 0;   ///< ‖∇v‖ up to which the factor is `floor`, value units per mm
  float to = 1;     ///< ‖∇v‖ from which it is 1
  float floor = 0;  ///< 0…1

  /// Factor of the extinction where ‖∇v‖ = `steepness`: grows with it, linearly between the ends.
  float factor(float steepness) const {
    return floor + (1 - floor) * std::clamp((steepness - from) / (to - from), 0.0f, 1.0f);
  }
  /// What both ways to write one demand.
  bool valid() const { return from >= 0 && to > from && floor >= 0 && floor <= 1; }
};

}  // namespace clipgs
