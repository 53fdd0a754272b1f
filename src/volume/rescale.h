#pragma once

namespace clipgs {

/// How stored values become HU: HU = scale·stored + offset.
struct Rescale {
  float scale = 1;
  float offset = 0;
};

}  // namespace clipgs
