// Apart from the readers and writers of files, so that what needs the curve alone links without
// them.

#include <algorithm>
#include <cmath>

#include "core/image.h"

namespace clipgs {

float srgb_from_linear(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

float linear_from_srgb(float srgb) {
  const float x = std::clamp(srgb, 0.0f, 1.0f);
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

}  // namespace clipgs
