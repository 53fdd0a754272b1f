#include "volume/padding.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "volume/slice_flood.h"

namespace clipgs {
namespace {

constexpr float kLeastGapBelow = 0.1f;  // of what the other values span
constexpr float kLeastGapAbove = 1;     // the same; backgrounds may be white
constexpr float kMostAir = -500;        // HU; what has lower values, and says no more, is CT

bool fills_corners(const Volume& volume, float value) {
  int corners = 0;
  for (int z = 0; z < volume.dims.z; ++z) {
    for (const int y : {0, volume.dims.y - 1}) {
      for (const int x : {0, volume.dims.x - 1}) {
        corners += volume.at(x, y, z) == value ? 1 : 0;
      }
    }
  }
  return corners >= 2 * volume.dims.z;
}

/// The least and the largest of the values that are not `without`, of which there must be one.
VoxelValues::Range range_without(const VoxelValues& values, float without) {
  constexpr size_t kGrain = size_t{1} << 20;
  constexpr VoxelValues::Range kNone{std::numeric_limits<float>::max(),
                                     std::numeric_limits<float>::lowest()};
  std::vector<VoxelValues::Range> pieces((values.size() + kGrain - 1) / kGrain, kNone);
  parallel_for(values.size(), kGrain, [&](size_t begin, size_t end) {
    VoxelValues::Range& range = pieces[begin / kGrain];
    for (size_t i = begin; i < end; ++i) {
      if (const float value = values[i]; value != without) {
        range = {std::min(range.min, value), std::max(range.max, value)};
      }
    }
  });
  VoxelValues::Range all = kNone;
  for (const VoxelValues::Range& piece : pieces) {
    all = {std::min(all.min, piece.min), std::max(all.max, piece.max)};
  }
  return all;
}

bool is_ct(const Volume& volume, const VoxelValues::Range& others) {
  return volume.modality == Modality::kCt ||
         (volume.modality == Modality::kUnknown && others.min <= kMostAir);
}

/// `others`: the range of all values but this.
bool is_padding(const Volume& volume, float value, const VoxelValues::Range& others) {
  const float span = others.max - others.min;
  if (value < others.min) {
    return value < 0 && span > 0 && others.min - value > kLeastGapBelow * span;
  }
  return is_ct(volume, others) || (span > 0 && value - others.max > kLeastGapAbove * span);
}

}  // namespace

std::optional<Padding> remove_padding(Volume& volume) {
  const VoxelValues::Range all = volume.values.range();
  for (const float value : {all.min, all.max}) {
    if (!fills_corners(volume, value)) {
      continue;
    }
    const VoxelValues::Range others = range_without(volume.values, value);
    if (!is_padding(volume, value, others)) {
      continue;
    }
    // So low is no tissue wherever it lies; so high may be metal.
    std::vector<std::uint8_t> picture(volume.voxels());
    for (size_t i = 0; i < picture.size(); ++i) {
      picture[i] = volume.values[i] == value ? 0 : 1;
    }
    if (value == all.max) {
      const std::vector<std::uint8_t> outside = flood_slices(volume.dims, picture);
      std::ranges::transform(outside, picture.begin(),
                             [](std::uint8_t reached) { return reached != 0 ? 0 : 1; });
    }
    volume.values.set_where(is_ct(volume, others) ? kAirHu : 0.0f,
                            [&](size_t i) { return picture[i] == 0; });
    return Padding{value, static_cast<size_t>(std::ranges::count(picture, 0))};
  }
  return std::nullopt;
}

}  // namespace clipgs
