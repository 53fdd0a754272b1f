#include "volume/upsample.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "volume/crop.h"
#include "volume/fine_grid.h"
#include "volume/surface_flow.h"

namespace clipgs {
namespace {

/// The values in 16 bits, in equal steps from the least to the largest.
VoxelValues in_steps(const std::vector<float>& values, const VoxelValues::Range& range) {
  constexpr size_t kCodes = size_t{1} << 16;
  const float step = range.max > range.min ? (range.max - range.min) / (kCodes - 1) : 1;
  std::vector<float> meaning(kCodes);
  for (size_t i = 0; i < kCodes; ++i) {
    meaning[i] = range.min + static_cast<float>(i) * step;
  }
  std::vector<std::uint16_t> codes(values.size());
  parallel_for(values.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const float code = (values[i] - range.min) / step;
      codes[i] = static_cast<std::uint16_t>(std::lround(std::clamp(code, 0.0f, kCodes - 1.0f)));
    }
  });
  return {std::move(codes), std::move(meaning)};
}

using Ranges = std::vector<VoxelValues::Range>;

void widen(VoxelValues::Range& range, const VoxelValues::Range& by) {
  range = {std::min(range.min, by.min), std::max(range.max, by.max)};
}

/// The ranges of values in every plane across each axis.
std::array<Ranges, 3> ranges_of_planes(const Volume& volume) {
  constexpr VoxelValues::Range kNone{std::numeric_limits<float>::max(),
                                     std::numeric_limits<float>::lowest()};
  std::vector<std::array<Ranges, 3>> of_slices(static_cast<size_t>(volume.dims.z));
  parallel_for(of_slices.size(), 1, [&](size_t z, size_t) {
    auto& [across_x, across_y, across_z] = of_slices[z];
    across_x.assign(static_cast<size_t>(volume.dims.x), kNone);
    across_z.assign(1, kNone);
    for (int y = 0; y < volume.dims.y; ++y) {
      VoxelValues::Range row = kNone;
      for (int x = 0; x < volume.dims.x; ++x) {
        const float value = volume.at(x, y, static_cast<int>(z));
        widen(across_x[static_cast<size_t>(x)], {value, value});
        widen(row, {value, value});
      }
      across_y.push_back(row);
      widen(across_z.front(), row);
    }
  });
  std::array<Ranges, 3> all = of_slices.front();
  all[2].clear();
  for (const auto& slice : of_slices) {
    for (size_t axis = 0; axis < 2; ++axis) {
      for (size_t i = 0; i < all[axis].size(); ++i) {
        widen(all[axis][i], slice[axis][i]);
      }
    }
    all[2].push_back(slice[2].front());
  }
  return all;
}

/// The voxels between planes that, with the next ones, have no value that is shown: interpolation
/// passes through all between two. Empty where nothing is shown.
VoxelBox shown_voxels(const Volume& volume, const TransferFunction& transfer) {
  constexpr int kMargin = 3;  // voxels: surfaces flow with those around them
  const std::array<Ranges, 3> planes = ranges_of_planes(volume);
  VoxelBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const Ranges& ranges = planes[static_cast<size_t>(axis)];
    const auto shows = [&](int i) {
      VoxelValues::Range range = ranges[static_cast<size_t>(i)];
      widen(range, ranges[static_cast<size_t>(std::min(i + 1, volume.dims[axis] - 1))]);
      return transfer.max_extinction(range.min, range.max) > 0;
    };
    int low = 0;
    int high = volume.dims[axis] - 1;
    while (low <= high && !shows(low)) {
      ++low;
    }
    if (low > high) {
      return {};
    }
    while (high > low && !shows(high)) {
      --high;
    }
    box.low[axis] = std::max(low - kMargin, 0);
    box.high[axis] = std::min(high + kMargin, volume.dims[axis] - 1);
  }
  return box;
}

std::vector<std::uint8_t> nearest_labels(const Volume& volume, const FineGrid& grids) {
  std::vector<std::uint8_t> labels(grids.fine_count());
  const auto nearest = [](const Between& at) { return at.t < 0.5f ? at.low : at.high; };
  for_each_voxel(grids.fine, [&](int x, int y, int z) {
    labels[grids.fine_at(x, y, z)] =
        volume.labels[volume.offset(nearest(grids.between[0][static_cast<size_t>(x)]),
                                    nearest(grids.between[1][static_cast<size_t>(y)]),
                                    nearest(grids.between[2][static_cast<size_t>(z)]))];
  });
  return labels;
}

}  // namespace

IVec3 upsampling_factors(const VolumeSize& size) {
  struct Refinement {
    int finer;    // voxels for one along the finest axis,
    float shown;  // unless so many of them span the longest
  };
  constexpr std::array kRefinements = {Refinement{3, 480}, Refinement{2, 1024}};
  constexpr int kMost = 6;  // the flow bridges no more in its steps
  if (size.rgb) {
    return IVec3(1);
  }
  const Vec3& spacing = size.spacing;
  const Vec3 extent = Vec3(size.dims) * spacing;
  const float least = std::min({spacing.x, spacing.y, spacing.z});
  const float longest = std::max({extent.x, extent.y, extent.z});
  const auto factors_for = [&](float goal) {
    return glm::max(IVec3(glm::round(spacing / goal)), IVec3(1));
  };
  const auto fits = [&](const IVec3& factors) {
    VolumeSize fine = size;
    fine.dims = (size.dims - 1) * factors + 1;
    return fine.voxels() <= kMostUpsampled;
  };
  for (const auto& [finer, shown] : kRefinements) {
    const float goal = least / static_cast<float>(finer);
    const IVec3 factors = factors_for(goal);
    if (longest <= shown * goal && std::max({factors.x, factors.y, factors.z}) <= kMost &&
        fits(factors)) {
      return factors;
    }
  }
  const IVec3 cubes = glm::min(factors_for(least), IVec3(kMost));
  return fits(cubes) ? cubes : IVec3(1);
}

bool can_be_upsampled(const Volume& volume) {
  return can_be_upsampled(VolumeSize{.dims = volume.dims, .rgb = !volume.rgb.empty()});
}

VolumeSize most_upsampled(VolumeSize size) {
  constexpr std::uint64_t kMostForOne = 54;
  size.scanned = false;
  if (!can_be_upsampled(size)) {
    return size;
  }
  const std::uint64_t most = std::min(kMostUpsampled, kMostForOne * size.voxels());
  size.dims = IVec3(static_cast<int>(std::ceil(std::cbrt(static_cast<double>(most)))));
  return size;
}

std::uint64_t upsampling_memory(const VolumeSize& size) {
  const VolumeSize fine = most_upsampled(size);
  if (fine.dims == size.dims) {
    return 0;
  }
  // SurfaceFlow's least_ and most_ (half as much where they fit in 16 bits), at_surface_ and what
  // is missing; values_ and freedom_. Then the result takes the place of freedom_. Of a part of the
  // volume that is small enough to be upsampled. And the copy of the volume that becomes the
  // result.
  constexpr std::uint64_t kScanned = 3 * sizeof(float) + sizeof(std::uint8_t);
  constexpr std::uint64_t kFine = sizeof(float) + sizeof(std::uint16_t);
  return std::min(size.voxels(), kMostUpsampled / 2) * kScanned + fine.voxels() * kFine +
         size.loaded();
}

Volume upsample(Volume volume, const IVec3& factors, const TransferFunction& transfer) {
  const auto [least, most] = std::minmax({factors.x, factors.y, factors.z});
  if (least < 1) {
    throw Error("voxels can be made finer by whole factors from 1, not by {}", least);
  }
  volume.scanned = {};
  if (most == 1) {
    return volume;
  }
  const FineGrid grids(volume, factors);
  volume.values = in_steps(flow_surfaces(volume, transfer, grids), volume.values.range());
  if (!volume.labels.empty()) {
    volume.labels = nearest_labels(volume, grids);
  }
  volume.dims = grids.fine;
  volume.spacing = grids.spacing;
  volume.upsampling *= factors;
  return volume;
}

Volume upsample(Volume volume, const TransferFunction& transfer) {
  volume.scanned = {};
  if (!can_be_upsampled(volume)) {
    return volume;
  }
  const VoxelBox shown = shown_voxels(volume, transfer);
  if (glm::all(glm::greaterThan(shown.dims(), IVec3(1)))) {
    crop(volume, shown);
  }
  const IVec3 factors = upsampling_factors({.dims = volume.dims, .spacing = volume.spacing});
  return upsample(std::move(volume), factors, transfer);
}

}  // namespace clipgs
