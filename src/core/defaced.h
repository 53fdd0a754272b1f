#pragma once

namespace clipgs {

/// What was taken off a head with its face.
struct Defaced {
  float removed_ml = 0;  ///< of what is no air or background
  float brain_mm = 0;    ///< nothing nearer to the brain was touched

  bool operator==(const Defaced&) const = default;
};

}  // namespace clipgs
