#include "volume/denoise_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"
#include "volume/matter.h"
#include "volume/rewrite_values.h"

namespace clipgs {
namespace {

constexpr int kReach = 2;  // voxels, of those that are averaged
constexpr int kPatch = 1;  // voxels around each, which are compared
constexpr int kHalo = kReach + kPatch;
constexpr int kRows = 16;  // of a slice at a time: what they need stays in the cache
/// A patch that differs by so many variances more than two of noise do has no weight. On the
/// phantom with noise of 10 to 40 HU less leaves more noise, and more blurs fine vessels.
constexpr float kTolerance = 1.2f;

/// The voxels that some rows of a slice are made of; beyond the volume its border.
struct Surroundings {
  int width;   // with the halo
  int height;  // the same
  std::array<std::vector<float>, 2 * kHalo + 1> slices;
  bool even = true;  // all of them the same

  const float* row(int slice, int y) const {
    return &slices[size_t{kHalo} + slice][(size_t{kHalo} + y) * width + kHalo];
  }
};

Surroundings surroundings(const Volume& volume, int first, int rows, int z) {
  Surroundings around{volume.dims.x + 2 * kHalo, rows + 2 * kHalo, {}, true};
  for (int k = -kHalo; k <= kHalo; ++k) {
    std::vector<float>& slice = around.slices[size_t{kHalo} + k];
    slice.reserve(static_cast<size_t>(around.width) * around.height);
    const int from_z = std::clamp(z + k, 0, volume.dims.z - 1);
    for (int j = -kHalo; j < rows + kHalo; ++j) {
      const size_t from = volume.offset(0, std::clamp(first + j, 0, volume.dims.y - 1), from_z);
      for (int i = -kHalo; i < volume.dims.x + kHalo; ++i) {
        slice.push_back(
            volume.values[from + static_cast<size_t>(std::clamp(i, 0, volume.dims.x - 1))]);
      }
    }
    const float value = around.slices[0].front();
    around.even =
        around.even && std::ranges::all_of(slice, [value](float v) { return v == value; });
  }
  return around;
}

/// Weighted sums of some rows, and the weights.
struct Sums {
  std::vector<float> values;
  std::vector<float> weights;
  std::vector<float> largest;  ///< weight
};

/// Adds the voxels that lie `step` away.
void add_neighbours(const Surroundings& around, int width, int rows, const IVec3& step,
                    float variance, Sums& sums) {
  const int wide = width + 2 * kPatch;
  // Squared differences, summed over the slices of a patch.
  std::vector<float> squares(static_cast<size_t>(wide) * (rows + 2 * kPatch), 0.0f);
  for (int k = -kPatch; k <= kPatch; ++k) {
    for (int j = -kPatch; j < rows + kPatch; ++j) {
      const float* const here = around.row(k, j) - kPatch;
      const float* const there = around.row(k + step.z, j + step.y) + step.x - kPatch;
      float* const out = &squares[static_cast<size_t>(j + kPatch) * wide];
      for (int i = 0; i < wide; ++i) {
        const float difference = here[i] - there[i];
        out[i] += difference * difference;
      }
    }
  }
  constexpr float kVoxels = (2 * kPatch + 1) * (2 * kPatch + 1) * (2 * kPatch + 1);
  const float scale = 1 / (kVoxels * kTolerance * variance);
  constexpr float kOfNoise = 2 / kTolerance;
  std::vector<float> columns(wide);
  for (int j = 0; j < rows; ++j) {
    const float* const above = &squares[static_cast<size_t>(j) * wide];
    for (int i = 0; i < wide; ++i) {
      columns[i] = above[i] + above[wide + i] + above[2 * wide + i];
    }
    const float* const there = around.row(step.z, j + step.y) + step.x;
    const size_t at = static_cast<size_t>(j) * width;
    for (int i = 0; i < width; ++i) {
      const float sum = columns[i] + columns[i + 1] + columns[i + 2];
      const float unlike = std::max(sum * scale - kOfNoise, 0.0f);
      const float alike = std::max(1 - unlike, 0.0f);
      const float weight = alike * alike;
      sums.values[at + i] += weight * there[i];
      sums.weights[at + i] += weight;
      sums.largest[at + i] = std::max(sums.largest[at + i], weight);
    }
  }
}

void denoise_rows(const Volume& volume, int first, int rows, int z, float variance, float* out) {
  const Surroundings around = surroundings(volume, first, rows, z);
  const int width = volume.dims.x;
  const size_t count = static_cast<size_t>(width) * rows;
  if (around.even) {
    std::fill_n(out, count, around.slices[0].front());
    return;
  }
  Sums sums{std::vector<float>(count), std::vector<float>(count), std::vector<float>(count)};
  for (int k = -kReach; k <= kReach; ++k) {
    for (int j = -kReach; j <= kReach; ++j) {
      for (int i = -kReach; i <= kReach; ++i) {
        if (i != 0 || j != 0 || k != 0) {
          add_neighbours(around, width, rows, {i, j, k}, variance, sums);
        }
      }
    }
  }
  for (size_t i = 0; i < count; ++i) {
    // The voxel itself, which is like itself even in its noise, counts as the likest of the others.
    const float own = around.row(0, static_cast<int>(i) / width)[static_cast<int>(i) % width];
    const float weight = sums.weights[i] + sums.largest[i];
    out[i] = weight > 0 ? (sums.values[i] + sums.largest[i] * own) / weight : own;
  }
}

}  // namespace

float estimate_noise(const Volume& volume) {
  constexpr size_t kBins = 1 << 16;
  constexpr int kTogether = 16;         // slices
  constexpr float kNorm = 6;            // of the mask
  constexpr float kOfNormal = 1.4826f;  // standard deviation over median magnitude
  const IVec3 dims = volume.dims;
  const float least = least_matter(volume);
  const VoxelValues::Range range = volume.values.range();
  const float bin_width = (range.max - range.min) / kBins;
  const auto pieces = static_cast<size_t>((dims.z + kTogether - 1) / kTogether);
  std::vector<std::vector<std::uint64_t>> counts(pieces, std::vector<std::uint64_t>(kBins));
  parallel_for(static_cast<size_t>(dims.z), kTogether, [&](size_t begin, size_t end) {
    std::vector<std::uint64_t>& own = counts[begin / kTogether];
    for (auto z = static_cast<int>(begin); z < static_cast<int>(end); ++z) {
      for (int y = 1; y < dims.y - 1; ++y) {
        for (int x = 1; x < dims.x - 1; ++x) {
          constexpr std::array<float, 3> kMask{1, -2, 1};
          float sum = 0;
          bool matter = true;
          for (int n = 0; n < 9; ++n) {
            const float value = volume.at(x - 1 + n % 3, y - 1 + n / 3, z);
            sum += kMask[n % 3] * kMask[n / 3] * value;
            matter = matter && value > least;
          }
          if (matter) {
            ++own[std::min(static_cast<size_t>(std::abs(sum) / kNorm / bin_width), kBins - 1)];
          }
        }
      }
    }
  });
  std::vector<std::uint64_t> all(kBins);
  std::uint64_t total = 0;
  for (const std::vector<std::uint64_t>& piece : counts) {
    for (size_t i = 0; i < kBins; ++i) {
      all[i] += piece[i];
      total += piece[i];
    }
  }
  size_t median = 0;
  for (std::uint64_t below = all[0]; 2 * below < total; below += all[median]) {
    ++median;
  }
  return kOfNormal * bin_width * static_cast<float>(median);
}

void denoise_values(Volume& volume, float sigma) {
  const VoxelValues::Range range = volume.values.range();
  rewrite_values(volume, value_step(range.max - range.min), [&](int z, float* slice) {
    for (int y = 0; y < volume.dims.y; y += kRows) {
      denoise_rows(volume, y, std::min(kRows, volume.dims.y - y), z, sigma * sigma,
                   slice + static_cast<size_t>(y) * volume.dims.x);
    }
  });
}

}  // namespace clipgs
