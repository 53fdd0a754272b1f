#pragma once

#include <algorithm>
#include <limits>

namespace clipgs {

/// The part of a ray, in its own units from its origin, that half spaces leave.
template <typename T>
struct RaySpan {
  T enter = 0;
  T leave = std::numeric_limits<T>::max();

  /// Leaves what lies at `height` + t·`slope` ≥ 0.
  void keep(T height, T slope) {
    if (slope > 0) {
      enter = std::max(enter, -height / slope);
    } else if (slope < 0) {
      leave = std::min(leave, -height / slope);
    } else if (height < 0) {
      leave = enter;
    }
  }
};

}  // namespace clipgs
