#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// 8-bit codes ↔ values of a volume (HU for CT): increasing, linear between neighbouring codes.
class ValueCurve {
 public:
  static constexpr size_t kCodes = 256;

  /// Code c means value c.
  ValueCurve();
  /// The values of codes 0…255. Throws Error unless there are 256 finite ones that increase.
  explicit ValueCurve(const std::vector<float>& values);

  /// Value of a code in [0, 255]; fractions come from interpolation between voxels.
  float value(float code) const;
  /// The inverse; values beyond the ends are clamped.
  float code(float value) const;
  const std::array<float, kCodes>& values() const { return values_; }

 private:
  std::array<float, kCodes> values_{};
};

/// How much each value of a volume matters: equal bins over [low, high].
struct ValueImportance {
  float low = 0;
  float high = 1;
  std::vector<double> frequency;    ///< how often the bin's values occur, any unit
  std::vector<double> sensitivity;  ///< how much a change of one value unit is seen, any unit
};

/// The curve that spends its codes, from `first` on, where errors are seen. For many codes the mean
/// squared visible error Σ frequency·(sensitivity·step)² is least when the density of codes is ∝
/// ∛(frequency·sensitivity²) (Panter & Dite 1951); a floor keeps the longest step within a few
/// times the mean step. Codes below `first` stand for values just below `low`. Throws Error unless
/// low < high, there are bins and first < 255.
ValueCurve fit_value_curve(const ValueImportance& importance, size_t first);

}  // namespace clipgs
