#pragma once

#include <array>
#include <cstdint>

#include "volume/volume.h"

namespace clipgs {

/// How often each value occurs, over equal bins from the smallest to the largest value.
struct Histogram {
  static constexpr int kBins = 4096;

  float min = 0;
  float max = 0;
  std::array<std::uint64_t, kBins> counts{};

  float bin_width() const { return (max - min) / kBins; }
  /// The value that `share` (0…1) of the voxels above `threshold` lie below.
  float quantile(float share, float threshold) const;
  /// The share (0…1) of all voxels in [low, high).
  float share_between(float low, float high) const;
};

Histogram histogram(const Volume& volume);

/// The threshold that best separates the histogram into two classes (Otsu 1979): background and
/// foreground of a scan.
float otsu_threshold(const Histogram& histogram);

/// The middle between Otsu's threshold and the mean of what is below it: background is below, dim
/// parts of the foreground are not.
float least_signal(const Histogram& histogram);

}  // namespace clipgs
