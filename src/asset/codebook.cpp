#include "asset/codebook.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_sort.h>

namespace clipgs {

namespace {

constexpr size_t kLevels = 256;
constexpr size_t kQuantiles = 512;
constexpr int kIterations = 48;

/// Levels whose density is the cube root of that of the sorted samples: an interval between two
/// quantiles, of equal mass and width w, gets levels in proportion to w^(2/3).
std::array<float, kLevels> companded_levels(const std::vector<float>& sorted) {
  std::array<double, kQuantiles + 1> edges{};
  std::array<double, kQuantiles + 1> cumulated{};
  for (size_t q = 0; q <= kQuantiles; ++q) {
    edges[q] = sorted[q * (sorted.size() - 1) / kQuantiles];
    if (q > 0) {
      cumulated[q] = cumulated[q - 1] + std::pow(edges[q] - edges[q - 1], 2.0 / 3);
    }
  }
  std::array<float, kLevels> levels{};
  size_t q = 1;
  for (size_t k = 0; k < kLevels; ++k) {
    const double target = cumulated.back() * (static_cast<double>(k) + 0.5) / kLevels;
    while (q < kQuantiles && cumulated[q] < target) {
      ++q;
    }
    const double within = (target - cumulated[q - 1]) / (cumulated[q] - cumulated[q - 1]);
    levels[k] = static_cast<float>(edges[q - 1] + within * (edges[q] - edges[q - 1]));
  }
  return levels;
}

}  // namespace

std::uint8_t Codebook::nearest(float x) const {
  const auto* const above = std::ranges::lower_bound(values, x);
  if (above == values.begin()) {
    return 0;
  }
  const auto index = static_cast<size_t>(above - values.begin());
  const bool below = index == kLevels || x - values[index - 1] <= values[index] - x;
  return static_cast<std::uint8_t>(below ? index - 1 : index);
}

Codebook fit_codebook(std::vector<float> samples) {
  Codebook codebook;
  if (samples.empty()) {
    return codebook;
  }
  tbb::parallel_sort(samples.begin(), samples.end());

  std::vector<float> different;
  for (const float x : samples) {
    if (different.empty() || x != different.back()) {
      different.push_back(x);
      if (different.size() > kLevels) {
        break;
      }
    }
  }
  if (different.size() <= kLevels) {
    codebook.values.fill(different.back());
    std::ranges::copy(different, codebook.values.begin());
    return codebook;
  }

  std::vector<double> sums(samples.size() + 1, 0);
  for (size_t i = 0; i < samples.size(); ++i) {
    sums[i + 1] = sums[i] + samples[i];
  }
  std::array<float, kLevels>& levels = codebook.values;
  levels = companded_levels(samples);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    size_t begin = 0;
    for (size_t k = 0; k < kLevels; ++k) {
      size_t end = samples.size();
      if (k + 1 < kLevels) {
        const float border = 0.5f * (levels[k] + levels[k + 1]);
        end = static_cast<size_t>(std::ranges::lower_bound(samples, border) - samples.begin());
      }
      if (end > begin) {
        levels[k] =
            static_cast<float>((sums[end] - sums[begin]) / static_cast<double>(end - begin));
        begin = end;
      }
    }
  }
  // An empty level may have been overtaken by its neighbour.
  std::ranges::sort(levels);
  return codebook;
}

}  // namespace clipgs
