#include "study/shapiro_wilk.h"

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <vector>

#include "core/error.h"

namespace clipgs {

namespace {

// Royston's polynomials, the constant first: of 1/√n for the two outer weights, of n or ln n for
// the mean and the logarithm of the standard deviation of W made normal.
constexpr std::array kOuterWeight{0.0, 0.221157, -0.147981, -2.071190, 4.434685, -2.706056};
constexpr std::array kNextWeight{0.0, 0.042981, -0.293762, -1.752461, 5.682633, -3.582633};
constexpr std::array kSmallGamma{-2.273, 0.459};
constexpr std::array kSmallMean{0.5440, -0.39978, 0.025054, -6.714e-4};
constexpr std::array kSmallLogSd{1.3822, -0.77857, 0.062767, -0.0020322};
constexpr std::array kLargeMean{-1.5861, -0.31082, -0.083751, 0.0038915};
constexpr std::array kLargeLogSd{-0.4803, -0.082676, 0.0030302};
/// Up to this many values the first kind is taken.
constexpr size_t kMostSmall = 11;

double polynomial(std::span<const double> coefficients, double x) {
  double value = 0;
  for (size_t i = coefficients.size(); i-- > 0;) {
    value = value * x + coefficients[i];
  }
  return value;
}

/// Weights of the upper half of the order statistics, the largest value's first; those of the lower
/// half are their negatives, and a middle one is 0. Their squares sum to ½.
std::vector<double> upper_weights(size_t n) {
  if (n == 3) {
    return {std::sqrt(0.5)};
  }
  const auto count = static_cast<double>(n);
  std::vector<double> scores(n / 2);  // Blom's approximation of normal order statistics
  double squares = 0;
  for (size_t i = 0; i < scores.size(); ++i) {
    const double share = (static_cast<double>(i) + 0.625) / (count + 0.25);
    scores[i] = -boost::math::quantile(boost::math::normal(), share);
    squares += 2 * scores[i] * scores[i];
  }
  const double x = 1 / std::sqrt(count);
  std::vector<double> weights = {polynomial(kOuterWeight, x) + scores[0] / std::sqrt(squares)};
  if (n > 5) {
    weights.push_back(polynomial(kNextWeight, x) + scores[1] / std::sqrt(squares));
  }
  double rest = squares;
  double left = 1;
  for (size_t i = 0; i < weights.size(); ++i) {
    rest -= 2 * scores[i] * scores[i];
    left -= 2 * weights[i] * weights[i];
  }
  const double scale = std::sqrt(left / rest);
  for (size_t i = weights.size(); i < scores.size(); ++i) {
    weights.push_back(scores[i] * scale);
  }
  return weights;
}

/// P(W ≤ 1 − `gap`) of n normal values.
double p_value(double gap, size_t n) {
  const auto count = static_cast<double>(n);
  if (n == 3) {  // exact
    const double pi = boost::math::constants::pi<double>();
    return std::clamp(6 / pi * (std::asin(std::sqrt(1 - gap)) - std::asin(std::sqrt(0.75))), 0.0,
                      1.0);
  }
  double y = std::log(gap);
  double mean = 0;
  double sd = 0;
  if (n <= kMostSmall) {
    const double gamma = polynomial(kSmallGamma, count);
    if (y >= gamma) {
      return 0;
    }
    y = -std::log(gamma - y);
    mean = polynomial(kSmallMean, count);
    sd = std::exp(polynomial(kSmallLogSd, count));
  } else {
    mean = polynomial(kLargeMean, std::log(count));
    sd = std::exp(polynomial(kLargeLogSd, std::log(count)));
  }
  return boost::math::cdf(boost::math::complement(boost::math::normal(mean, sd), y));
}

}  // namespace

std::optional<ShapiroWilk> shapiro_wilk(std::span<const double> values) {
  const size_t n = values.size();
  if (n < kFewestForShapiroWilk || n > kMostForShapiroWilk ||
      !std::ranges::all_of(values, [](double v) { return std::isfinite(v); })) {
    throw Error("Shapiro and Wilk's test takes {} to {} finite values, not {}; check the data",
                kFewestForShapiroWilk, kMostForShapiroWilk, n);
  }
  std::vector<double> sorted(values.begin(), values.end());
  std::ranges::sort(sorted);
  const double range = sorted.back() - sorted.front();
  if (!(range > 0)) {
    return std::nullopt;
  }
  double mean = 0;
  for (double& value : sorted) {  // scaled: no square overflows
    value = (value - sorted.back()) / range;
    mean += value / static_cast<double>(n);
  }
  double squares = 0;
  for (const double value : sorted) {
    squares += (value - mean) * (value - mean);
  }
  const std::vector<double> weights = upper_weights(n);
  double product = 0;
  double weight_squares = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    product += weights[i] * (sorted[n - 1 - i] - sorted[i]);
    weight_squares += 2 * weights[i] * weights[i];
  }
  // 1 − W, without the rounding of W near 1.
  const double norm = std::sqrt(weight_squares * squares);
  const double gap = std::max((norm - product) * (norm + product) / (norm * norm), 0.0);
  if (gap == 0) {
    return ShapiroWilk{1, 1};
  }
  return ShapiroWilk{1 - gap, p_value(gap, n)};
}

}  // namespace clipgs
