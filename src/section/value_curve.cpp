#include "section/value_curve.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"

namespace clipgs {

ValueCurve::ValueCurve() { std::iota(values_.begin(), values_.end(), 0.0f); }

ValueCurve::ValueCurve(const std::vector<float>& values) {
  if (values.size() != kCodes) {
    throw Error("section: the value curve has {} entries, not {}", values.size(), kCodes);
  }
  for (size_t i = 0; i < kCodes; ++i) {
    if (!std::isfinite(values[i]) || (i > 0 && !(values[i] > values[i - 1]))) {
      throw Error("section: the value curve does not increase at code {}", i);
    }
    values_[i] = values[i];
  }
}

float ValueCurve::value(float code) const {
  const float at = std::clamp(code, 0.0f, static_cast<float>(kCodes - 1));
  const size_t low = std::min(static_cast<size_t>(at), kCodes - 2);
  return values_[low] + (at - static_cast<float>(low)) * (values_[low + 1] - values_[low]);
}

float ValueCurve::code(float value) const {
  const auto above =
      static_cast<size_t>(std::ranges::upper_bound(values_, value) - values_.begin());
  if (above == 0) {
    return 0;
  }
  if (above == kCodes) {
    return static_cast<float>(kCodes - 1);
  }
  const float low = values_[above - 1];
  return static_cast<float>(above - 1) + (value - low) / (values_[above] - low);
}

ValueCurve fit_value_curve(const ValueImportance& importance, size_t first) {
  const size_t bins = importance.frequency.size();
  if (bins == 0 || importance.sensitivity.size() != bins || !(importance.low < importance.high) ||
      first + 1 >= ValueCurve::kCodes) {
    throw Error("section: no values to fit a curve to");
  }
  std::vector<double> density(bins);
  for (size_t i = 0; i < bins; ++i) {
    const double s = importance.sensitivity[i];
    density[i] = std::cbrt(importance.frequency[i] * s * s);
  }
  const double mean =
      std::accumulate(density.begin(), density.end(), 0.0) / static_cast<double>(bins);
  // Values that hardly occur must still be told apart a little.
  constexpr double kFloor = 0.2;
  const double floor = mean > 0 ? kFloor * mean : 1.0;
  std::vector<double> upto(bins + 1, 0.0);
  for (size_t i = 0; i < bins; ++i) {
    upto[i + 1] = upto[i] + std::max(density[i], floor);
  }

  const double width =
      (static_cast<double>(importance.high) - importance.low) / static_cast<double>(bins);
  std::vector<float> values(ValueCurve::kCodes);
  for (size_t c = 0; c < first; ++c) {
    values[c] = static_cast<float>(importance.low - static_cast<double>(first - c) * width);
  }
  size_t bin = 0;
  const auto steps = static_cast<double>(ValueCurve::kCodes - 1 - first);
  for (size_t c = first; c < values.size(); ++c) {
    const double target = upto.back() * static_cast<double>(c - first) / steps;
    while (bin + 1 < bins && upto[bin + 1] < target) {
      ++bin;
    }
    const double within = (target - upto[bin]) / (upto[bin + 1] - upto[bin]);
    values[c] = static_cast<float>(importance.low + (static_cast<double>(bin) + within) * width);
  }
  return ValueCurve(values);
}

}  // namespace clipgs
