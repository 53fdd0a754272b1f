#include "volume/shows_table.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/histogram.h"
#include "volume/isolate_body.h"

namespace clipgs {
namespace {

constexpr float kAirValue = -1000;    // HU
constexpr float kTissue = 40;         // HU
constexpr double kLeastTable = 5;     // ml
constexpr double kMostlyPrism = 0.5;  // of what would be taken off
constexpr double kOfSlices = 0.9;
constexpr float kLeastWidth = 50;  // mm
constexpr int kLeastSlices = 10;   // fewer make a prism of everything

/// The brightest of each block, so that the thin shells of a table stay.
Volume coarse(const Volume& volume) {
  constexpr int kMost = 128;
  const IVec3 factor = (volume.dims + kMost - 1) / kMost;
  Volume small;
  small.dims = (volume.dims + factor - 1) / factor;
  small.spacing = volume.spacing * Vec3(factor);
  std::vector<float> values(small.voxels(), volume.values[0]);
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      const size_t row = volume.offset(0, y, z);
      const size_t out = small.offset(0, y / factor.y, z / factor.z);
      for (int x = 0; x < volume.dims.x; ++x) {
        float& value = values[out + static_cast<size_t>(x / factor.x)];
        const float stored = volume.values[row + static_cast<size_t>(x)];
        const bool first = x % factor.x == 0 && y % factor.y == 0 && z % factor.z == 0;
        value = first ? stored : std::max(value, stored);
      }
    }
  }
  small.values = std::move(values);
  return small;
}

/// The values as HU, if the two classes that Otsu's threshold parts are air and tissue.
std::vector<float> hu_of(const Volume& volume) {
  const float threshold = otsu_threshold(histogram(volume));
  std::array<double, 2> sums{};
  std::array<double, 2> counts{};
  for (size_t i = 0; i < volume.voxels(); ++i) {
    const float value = volume.values[i];
    const size_t matter = value > threshold ? 1 : 0;
    sums[matter] += value;
    counts[matter] += 1;
  }
  const double air = sums[0] / std::max(counts[0], 1.0);
  const double tissue = sums[1] / std::max(counts[1], 1.0);
  std::vector<float> hu(volume.voxels(), kAirValue);
  for (size_t i = 0; tissue > air && i < hu.size(); ++i) {
    hu[i] = static_cast<float>(kAirValue +
                               (kTissue - kAirValue) * (volume.values[i] - air) / (tissue - air));
  }
  return hu;
}

/// `taken`: what goes, one byte a voxel.
bool is_prism(const Volume& volume, const std::vector<std::uint8_t>& taken) {
  const size_t slice = static_cast<size_t>(volume.dims.x) * volume.dims.y;
  std::vector<int> counts(slice, 0);
  for (size_t i = 0; i < taken.size(); ++i) {
    counts[i % slice] += taken[i];
  }
  const double enough = kOfSlices * volume.dims.z;
  double all = 0;
  double in_prism = 0;
  glm::ivec2 low(volume.dims);
  glm::ivec2 high(0);
  for (size_t i = 0; i < slice; ++i) {
    all += counts[i];
    if (counts[i] >= enough) {
      in_prism += counts[i];
      const glm::ivec2 place(i % static_cast<size_t>(volume.dims.x),
                             i / static_cast<size_t>(volume.dims.x));
      low = glm::min(low, place);
      high = glm::max(high, place);
    }
  }
  const Vec2 size = Vec2(high - low + 1) * Vec2(volume.spacing);
  const double ml = double{volume.spacing.x} * volume.spacing.y * volume.spacing.z / 1000;
  return in_prism * ml >= kLeastTable && in_prism >= kMostlyPrism * all &&
         std::max(size.x, size.y) >= kLeastWidth;
}

}  // namespace

bool shows_table(const Volume& volume) {
  if (volume.dims.z < kLeastSlices) {
    return false;
  }
  Volume small = coarse(volume);
  small.values = hu_of(small);
  small.modality = Modality::kCt;
  std::vector<std::uint8_t> taken(small.voxels());
  for (size_t i = 0; i < taken.size(); ++i) {
    taken[i] = small.values[i] > kLeastMatter ? 1 : 0;
  }
  isolate_body(small);
  for (size_t i = 0; i < taken.size(); ++i) {
    taken[i] = taken[i] != 0 && small.values[i] <= kLeastMatter ? 1 : 0;
  }
  return is_prism(small, taken);
}

}  // namespace clipgs
