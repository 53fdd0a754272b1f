#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/tone.h"

namespace clipgs {

/// display_from_linear() by a table over the square root, which spreads the dark end: within 1e-5.
class DisplayCurve {
 public:
  explicit DisplayCurve(ToneCurve tone) : white_(untoned(1, tone)) {
    for (size_t i = 0; i < values_.size(); ++i) {
      const float root = static_cast<float>(i) / kSteps;
      values_[i] = display_from_linear(white_ * root * root, tone);
    }
  }
  float operator()(float linear) const {
    const float at = kSteps * std::sqrt(std::clamp(linear / white_, 0.0f, 1.0f));
    const size_t low = std::min(static_cast<size_t>(at), static_cast<size_t>(kSteps) - 1);
    return values_[low] + (at - static_cast<float>(low)) * (values_[low + 1] - values_[low]);
  }

 private:
  static constexpr float kSteps = 1024;
  float white_;  // light from which on all is white
  std::array<float, static_cast<size_t>(kSteps) + 1> values_;
};

inline const DisplayCurve& display_curve(ToneCurve tone) {
  static const DisplayCurve srgb(ToneCurve::kSrgb);
  static const DisplayCurve filmic(ToneCurve::kFilmic);
  return tone == ToneCurve::kFilmic ? filmic : srgb;
}

}  // namespace clipgs
