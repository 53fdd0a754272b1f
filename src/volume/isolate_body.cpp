#include "volume/isolate_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "volume/slice_flood.h"

namespace clipgs {
namespace {

constexpr float kAir = -1024;          // HU
constexpr float kLeastMatter = -300;   // HU; foam of cushions is lighter, skin is not
constexpr float kThinnest = 6;         // mm, half of what a part of the body must be thick
constexpr float kLeastPart = 0.01f;    // of the largest part: arms are, cables are not
constexpr float kLeastMean = -700;     // HU of a part with its holes; hollow tables have less
constexpr float kLongestTrifle = 100;  // mm; no ear or nose is longer, a table is
constexpr float kBone = 300;           // HU; attached to the body, of any length
constexpr float kSkin = 2;             // voxels around the body that keep their values
constexpr double kMostRemoved = 0.35;  // of all matter; more is no table

/// One byte a voxel: 0 or 1.
using Mask = std::vector<std::uint8_t>;

template <typename Body>
void for_each_slice(const Volume& volume, const Body& body) {
  parallel_for(static_cast<size_t>(volume.dims.z), 1,
               [&](size_t z, size_t) { body(static_cast<int>(z)); });
}

template <typename Decide>
Mask mask_where(const Volume& volume, const Decide& decide) {
  Mask mask(volume.voxels());
  const size_t slice = static_cast<size_t>(volume.dims.x) * volume.dims.y;
  for_each_slice(volume, [&](int z) {
    for (size_t i = z * slice; i < (z + 1) * slice; ++i) {
      mask[i] = decide(i) ? 1 : 0;
    }
  });
  return mask;
}

/// Matter, and all that it encloses in an axial slice: lungs belong to the chest.
Mask with_holes_filled(const Volume& volume, const Mask& matter) {
  const Mask outside = flood_slices(volume.dims, matter);
  return mask_where(volume, [&](size_t i) { return outside[i] == 0; });
}

/// 1 within `radius` (mm) of a 1 of the mask: squared distances along x, then the least sums of
/// squares along y and z.
Mask dilated(const Volume& volume, const Mask& mask, float radius) {
  constexpr float kFar = std::numeric_limits<float>::max();
  const IVec3 dims = volume.dims;
  const float limit = radius * radius;
  std::vector<float> squares(mask.size(), kFar);
  // One line of voxels; `old` has room for it.
  const auto widen_line = [&](size_t from, size_t stride, int count, float spacing,
                              std::vector<float>& old) {
    const int reach = static_cast<int>(radius / spacing);
    float least_of_line = kFar;
    for (int i = 0; i < count; ++i) {
      old[i] = squares[from + i * stride];
      least_of_line = std::min(least_of_line, old[i]);
    }
    if (least_of_line == kFar) {
      return;
    }
    for (int i = 0; i < count; ++i) {
      if (old[i] == 0) {
        continue;
      }
      float least = old[i];
      for (int step = 1; step <= reach; ++step) {
        const float added = spacing * spacing * static_cast<float>(step * step);
        if (i >= step && old[i - step] < kFar) {
          least = std::min(least, old[i - step] + added);
        }
        if (i + step < count && old[i + step] < kFar) {
          least = std::min(least, old[i + step] + added);
        }
      }
      squares[from + i * stride] = least;
    }
  };
  for_each_slice(volume, [&](int z) {
    std::vector<float> old(std::max(dims.x, dims.y));
    for (int y = 0; y < dims.y; ++y) {
      const size_t row = volume.offset(0, y, z);
      for (int x = 0; x < dims.x; ++x) {
        squares[row + x] = mask[row + x] != 0 ? 0.0f : kFar;
      }
      widen_line(row, 1, dims.x, volume.spacing.x, old);
    }
    for (int x = 0; x < dims.x; ++x) {
      widen_line(volume.offset(x, 0, z), static_cast<size_t>(dims.x), dims.y, volume.spacing.y,
                 old);
    }
  });
  parallel_for(static_cast<size_t>(dims.y), 1, [&](size_t y, size_t) {
    std::vector<float> old(dims.z);
    for (int x = 0; x < dims.x; ++x) {
      widen_line(volume.offset(x, static_cast<int>(y), 0), static_cast<size_t>(dims.x) * dims.y,
                 dims.z, volume.spacing.z, old);
    }
  });
  return mask_where(volume, [&](size_t i) { return squares[i] <= limit; });
}

/// What is farther than `radius` (mm) from any 0; what lies beyond the picture counts as 1.
Mask eroded(const Volume& volume, const Mask& mask, float radius) {
  const Mask around =
      dilated(volume, mask_where(volume, [&](size_t i) { return mask[i] == 0; }), radius);
  return mask_where(volume, [&](size_t i) { return around[i] == 0; });
}

IVec3 place_of(const Volume& volume, size_t offset) {
  const auto width = static_cast<size_t>(volume.dims.x);
  const auto height = static_cast<size_t>(volume.dims.y);
  return IVec3(offset % width, offset / width % height, offset / (width * height));
}

/// Calls use(voxels) with the offsets of each connected component (by faces) of the mask.
template <typename Use>
void for_each_component(const Volume& volume, Mask mask, const Use& use) {
  const IVec3 dims = volume.dims;
  const std::array<std::ptrdiff_t, 3> strides = {1, dims.x, std::ptrdiff_t{dims.x} * dims.y};
  std::vector<size_t> voxels;
  for (size_t seed = 0; seed < mask.size(); ++seed) {
    if (mask[seed] == 0) {
      continue;
    }
    mask[seed] = 0;
    voxels.assign(1, seed);
    for (size_t next = 0; next < voxels.size(); ++next) {
      const size_t at = voxels[next];
      const IVec3 place = place_of(volume, at);
      for (int axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          const int there = place[axis] + step;
          const size_t neighbour = at + static_cast<size_t>(step * strides[axis]);
          if (there >= 0 && there < dims[axis] && mask[neighbour] != 0) {
            mask[neighbour] = 0;
            voxels.push_back(neighbour);
          }
        }
      }
    }
    use(voxels);
  }
}

/// The parts of `cores` that are large, and not hollow.
Mask body_cores(const Volume& volume, const Mask& cores) {
  size_t largest = 0;
  for_each_component(volume, cores, [&](const std::vector<size_t>& voxels) {
    largest = std::max(largest, voxels.size());
  });
  Mask body(cores.size(), 0);
  for_each_component(volume, cores, [&](const std::vector<size_t>& voxels) {
    double sum = 0;
    for (const size_t at : voxels) {
      sum += volume.values[at];
    }
    const auto size = static_cast<double>(voxels.size());
    if (size >= kLeastPart * static_cast<double>(largest) && sum / size > kLeastMean) {
      for (const size_t at : voxels) {
        body[at] = 1;
      }
    }
  });
  return body;
}

/// Adds to the body what of the matter is attached to it, and small or bone.
void add_trifles(const Volume& volume, const Mask& matter, Mask& body) {
  const Vec3& spacing = volume.spacing;
  const Mask near = dilated(volume, body, 1.01f * std::max({spacing.x, spacing.y, spacing.z}));
  const Mask rest = mask_where(volume, [&](size_t i) { return matter[i] != 0 && body[i] == 0; });
  for_each_component(volume, rest, [&](const std::vector<size_t>& voxels) {
    IVec3 low = volume.dims;
    IVec3 high(0);
    bool attached = false;
    double sum = 0;
    size_t solid = 0;
    for (const size_t at : voxels) {
      const IVec3 place = place_of(volume, at);
      low = glm::min(low, place);
      high = glm::max(high, place);
      attached = attached || near[at] != 0;
      if (volume.values[at] > kLeastMatter) {
        sum += volume.values[at];
        ++solid;
      }
    }
    const Vec3 size = Vec3(high - low + 1) * spacing;
    const bool small = std::max({size.x, size.y, size.z}) <= kLongestTrifle;
    if (attached && (small || sum > kBone * static_cast<double>(solid))) {
      for (const size_t at : voxels) {
        body[at] = 1;
      }
    }
  });
}

}  // namespace

double isolate_body(Volume& volume) {
  if (volume.modality != Modality::kCt || volume.values.range().min > kLeastMean) {
    return 0;
  }
  const Mask matter = mask_where(volume, [&](size_t i) { return volume.values[i] > kLeastMatter; });
  const Mask filled = with_holes_filled(volume, matter);
  const Vec3& s = volume.spacing;
  // Where slices are thick, rather some of the table than none of an ear that touches it.
  const float voxel = std::max({s.x, s.y, s.z});
  Mask body = dilated(volume, body_cores(volume, eroded(volume, filled, kThinnest)),
                      kThinnest + 1.5f * voxel);
  for (size_t i = 0; i < body.size(); ++i) {
    body[i] &= filled[i];
  }
  add_trifles(volume, filled, body);
  const Mask kept = dilated(volume, body, kSkin * voxel);

  const auto all = static_cast<double>(std::ranges::count(matter, 1));
  double removed = 0;
  for (size_t i = 0; i < kept.size(); ++i) {
    removed += matter[i] != 0 && kept[i] == 0 ? 1 : 0;
  }
  if (removed > kMostRemoved * all) {
    return 0;
  }
  volume.values.set_where(kAir, [&](size_t i) { return kept[i] == 0; });
  return removed * s.x * s.y * s.z / 1000;
}

}  // namespace clipgs
