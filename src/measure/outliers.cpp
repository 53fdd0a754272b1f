#include "measure/outliers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace clipgs {

namespace {

std::vector<double> present(std::span<const std::optional<double>> values) {
  std::vector<double> list;
  list.reserve(values.size());
  for (const std::optional<double>& value : values) {
    if (value) {
      list.push_back(*value);
    }
  }
  return list;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// Zero where all values are the same.
double robust_deviation(const std::vector<double>& values, double middle) {
  constexpr double kOfMedian = 1.4826;
  constexpr double kOfMean = 1.2533;
  std::vector<double> deviations;
  deviations.reserve(values.size());
  for (const double value : values) {
    deviations.push_back(std::abs(value - middle));
  }
  const double of_median = kOfMedian * median(deviations);
  if (of_median > 0) {
    return of_median;
  }
  const double sum = std::accumulate(deviations.begin(), deviations.end(), 0.0);
  return kOfMean * sum / static_cast<double>(deviations.size());
}

}  // namespace

std::optional<double> median_of(std::span<const std::optional<double>> values) {
  std::vector<double> list = present(values);
  return list.empty() ? std::nullopt : std::optional(median(std::move(list)));
}

std::vector<std::optional<double>> robust_scores(std::span<const std::optional<double>> values,
                                                 double least) {
  std::vector<std::optional<double>> scores(values.size());
  const std::vector<double> list = present(values);
  if (list.size() < kLeastForOutliers) {
    return scores;
  }
  const double middle = median(list);
  const double deviation = std::max(robust_deviation(list, middle), least);
  for (size_t i = 0; i < values.size(); ++i) {
    if (values[i]) {
      scores[i] = (*values[i] - middle) / deviation;
    }
  }
  return scores;
}

}  // namespace clipgs
