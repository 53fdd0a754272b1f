#pragma once

#include <algorithm>
#include <limits>

namespace clipgs {

/// The part of a ray, in its own units from its origin, that half spaces leave.
template <typename T>
struct RaySpan {
  T enter = 0;
  T leave = std::numeric_limits<T>::max();
  T slope = 0;  ///< at which it is entered; 0 from inside

  /// Leaves what lies at `height` + t·`rise` ≥ 0.
  void keep(T height, T rise) {
    if (rise > 0) {
      if (-height / rise > enter) {
        enter = -height / rise;
        slope = rise;
      }
    } else if (rise < 0) {
      leave = std::min(leave, -height / rise);
    } else if (height < 0) {
      leave = enter;
    }
  }
};

}  // namespace clipgs
