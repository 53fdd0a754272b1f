#include "volume/steepness_histogram.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"

namespace clipgs {
namespace {

/// Trilinear, at a continuous voxel index; beyond the volume its last voxels go on.
float value_at(const Volume& volume, const Vec3& index) {
  return volume.sample(volume.world_from_index(index));
}

/// ‖∇v‖ as pictures take it, value units per mm.
float steepness_at(const Volume& volume, const Vec3& index) {
  Vec3 slope;
  for (int k = 0; k < 3; ++k) {
    Vec3 step(0);
    step[k] = 1;
    slope[k] =
        (value_at(volume, index + step) - value_at(volume, index - step)) / (2 * volume.spacing[k]);
  }
  return glm::length(slope);
}

/// Calls use(value, steepness, counts) at places all over the volume with a value of the interval;
/// returns the sum of the counts of all threads.
template <typename Use>
std::vector<std::uint64_t> count_places(const Volume& volume, float low, float high, size_t bins,
                                        const Use& use) {
  constexpr size_t kPlaces = size_t{1} << 23;  // about, of larger volumes: curves are smooth then
  constexpr size_t kSlices = 16;               // counted together before they are added
  const size_t stride = (volume.voxels() + kPlaces - 1) / kPlaces;
  std::vector<std::uint64_t> sum(bins, 0);
  std::mutex adding;
  parallel_for(static_cast<size_t>(volume.dims.z), kSlices, [&](size_t begin, size_t end) {
    std::vector<std::uint64_t> counts(bins, 0);
    for (size_t z = begin; z < end; ++z) {
      Rng rng(1, z);
      const size_t slice = static_cast<size_t>(volume.dims.x) * volume.dims.y;
      for (size_t i = z % stride; i < slice; i += stride) {
        // Anywhere in the voxel: where few values are told apart, those between them are seen too.
        const Vec3 jitter(rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f);
        const Vec3 index = jitter + Vec3(i % static_cast<size_t>(volume.dims.x),
                                         i / static_cast<size_t>(volume.dims.x), z);
        const float value = value_at(volume, index);
        if (value >= low && value <= high) {
          use(value, steepness_at(volume, index), counts);
        }
      }
    }
    const std::scoped_lock lock(adding);
    for (size_t i = 0; i < bins; ++i) {
      sum[i] += counts[i];
    }
  });
  return sum;
}

/// What one place in a thousand with a value of an interval is steeper than, by bins of 2 %; 0 if
/// none has any slope.
float nearly_steepest(const Volume& volume, float low, float high) {
  constexpr float kBinsAnOctave = 32;
  constexpr float kFlattest = -20;  // as a power of two
  constexpr size_t kOctaves = 60;
  constexpr double kLeftOut = 1e-3;
  const std::vector<std::uint64_t> counts =
      count_places(volume, low, high, static_cast<size_t>(kOctaves * kBinsAnOctave),
                   [&](float, float steepness, std::vector<std::uint64_t>& bins) {
                     const float octave = steepness > 0 ? std::log2(steepness) - kFlattest : 0.0f;
                     const auto bin = static_cast<size_t>(std::max(octave, 0.0f) * kBinsAnOctave);
                     ++bins[std::min(bin, bins.size() - 1)];
                   });
  std::uint64_t all = 0;
  for (const std::uint64_t count : counts) {
    all += count;
  }
  std::uint64_t steeper = 0;
  for (size_t bin = counts.size() - 1; bin > 0; --bin) {
    steeper += counts[bin];
    if (static_cast<double>(steeper) > kLeftOut * static_cast<double>(all)) {
      return std::exp2(static_cast<float>(bin + 1) / kBinsAnOctave + kFlattest);
    }
  }
  return 0;
}

}  // namespace

SteepnessHistogram steepness_histogram(const Volume& volume, float low, float high,
                                       const std::string& where) {
  const auto [least, most] = volume.values.range();
  if (!(least < most)) {
    throw Error(
        "{}: every voxel has the value {:g}, there is no histogram of value and gradient to draw",
        where, least);
  }
  SteepnessHistogram result;
  result.low = std::max(low, least);
  result.high = std::min(high, most);
  if (result.low < result.high) {
    result.steepest = nearly_steepest(volume, result.low, result.high);
  }
  if (!(result.low < result.high) || result.steepest <= 0) {
    throw Error(
        "{}: between the values {:g} and {:g} the volume, of {:g} to {:g}, has no gradient to "
        "draw; "
        "choose another --preset",
        where, low, high, least, most);
  }
  constexpr int kLastColumn = SteepnessHistogram::kColumns - 1;
  const float across = SteepnessHistogram::kColumns / (result.high - result.low);
  const float upwards = SteepnessHistogram::kRows / result.steepest;
  const std::vector<std::uint64_t> counts = count_places(
      volume, result.low, result.high,
      size_t{SteepnessHistogram::kColumns} * SteepnessHistogram::kRows,
      [&](float value, float steepness, std::vector<std::uint64_t>& bins) {
        const float row = steepness * upwards;
        if (row < SteepnessHistogram::kRows) {
          const int column = std::min(static_cast<int>((value - result.low) * across), kLastColumn);
          ++bins[static_cast<size_t>(row) * SteepnessHistogram::kColumns +
                 static_cast<size_t>(column)];
        }
      });
  for (size_t row = 0; row < result.counts->size(); ++row) {
    std::copy_n(&counts[row * SteepnessHistogram::kColumns], SteepnessHistogram::kColumns,
                (*result.counts)[row].begin());
  }
  return result;
}

}  // namespace clipgs
