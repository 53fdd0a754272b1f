#include "volume/histogram.h"

#include <algorithm>
#include <numeric>

namespace clipgs {

Histogram histogram(const Volume& volume) {
  Histogram h;
  const auto [low, high] = volume.values.range();
  h.min = low;
  h.max = high;
  // In double: the inverse of a range of floats may be beyond them.
  const double range = static_cast<double>(h.max) - h.min;
  const double scale = range > 0 ? Histogram::kBins / range : 0;
  for (const float value : volume.values.all()) {
    const auto bin = static_cast<int>((static_cast<double>(value) - h.min) * scale);
    ++h.counts[std::min(bin, Histogram::kBins - 1)];
  }
  return h;
}

float Histogram::quantile(float share, float threshold) const {
  const float width = bin_width();
  if (width <= 0) {
    return min;
  }
  const int first = std::clamp(static_cast<int>((threshold - min) / width), 0, kBins - 1);
  const auto total = std::accumulate(counts.begin() + first, counts.end(), std::uint64_t{0});
  const double wanted = static_cast<double>(share) * static_cast<double>(total);
  double below = 0;
  for (int bin = first; bin < kBins; ++bin) {
    const auto count = static_cast<double>(counts[bin]);
    if (count > 0 && below + count >= wanted) {
      const auto part = static_cast<float>((wanted - below) / count);
      return min + (static_cast<float>(bin) + part) * width;
    }
    below += count;
  }
  return max;
}

float Histogram::share_between(float low, float high) const {
  std::uint64_t inside = 0;
  std::uint64_t total = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    const float value = min + (static_cast<float>(bin) + 0.5f) * bin_width();
    total += counts[bin];
    inside += value >= low && value < high ? counts[bin] : 0;
  }
  return total == 0 ? 0
                    : static_cast<float>(static_cast<double>(inside) / static_cast<double>(total));
}

float otsu_threshold(const Histogram& h) {
  double total = 0;
  double sum = 0;
  for (int bin = 0; bin < Histogram::kBins; ++bin) {
    total += static_cast<double>(h.counts[bin]);
    sum += static_cast<double>(h.counts[bin]) * bin;
  }
  double weight = 0;
  double weighted = 0;
  double best = -1;
  int best_bin = 0;
  for (int bin = 0; bin < Histogram::kBins - 1; ++bin) {
    weight += static_cast<double>(h.counts[bin]);
    weighted += static_cast<double>(h.counts[bin]) * bin;
    if (weight == 0 || weight == total) {
      continue;
    }
    const double gap = weighted / weight - (sum - weighted) / (total - weight);
    const double between = weight * (total - weight) * gap * gap;
    if (between > best) {
      best = between;
      best_bin = bin;
    }
  }
  return h.min + (static_cast<float>(best_bin) + 1) * h.bin_width();
}

float least_signal(const Histogram& h) {
  const float threshold = otsu_threshold(h);
  double sum = 0;
  double count = 0;
  for (int bin = 0; bin < Histogram::kBins; ++bin) {
    const float value = h.min + (static_cast<float>(bin) + 0.5f) * h.bin_width();
    const auto weight = value < threshold ? static_cast<double>(h.counts[bin]) : 0.0;
    sum += weight * value;
    count += weight;
  }
  return 0.5f * (threshold + static_cast<float>(sum / std::max(count, 1.0)));
}

}  // namespace clipgs
