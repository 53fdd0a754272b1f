#include "volume/metal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "volume/rewrite_values.h"

namespace clipgs {
namespace {

constexpr float kStreakReach = 60;  // mm, of streaks worth softening
constexpr float kWindow = 5;        // mm: two wedges of a fan of 3 degrees at 30 mm
constexpr float kMostUnlike = 600;  // HU; cortical bone and air differ more from soft tissue
constexpr float kLeastArea = 5;     // mm² of a slice; noise has less

/// mm within a slice to the nearest metal, to within 8 % (chamfer distances, Borgefors 1986).
std::vector<float> distances(const Volume& volume, int z, float least) {
  const int width = volume.dims.x;
  const int height = volume.dims.y;
  const float x_step = volume.spacing.x;
  const float y_step = volume.spacing.y;
  const float diagonal = std::hypot(x_step, y_step);
  std::vector<float> distance(static_cast<size_t>(width) * height);
  for (size_t i = 0; i < distance.size(); ++i) {
    const float value = volume.values[volume.offset(0, 0, z) + i];
    distance[i] = value >= least ? 0.0f : std::numeric_limits<float>::max();
  }
  const auto lower = [&](int x, int y, int dx, int dy, float step) {
    if (x + dx >= 0 && x + dx < width && y + dy >= 0 && y + dy < height) {
      float& here = distance[static_cast<size_t>(y) * width + x];
      here = std::min(here, distance[static_cast<size_t>(y + dy) * width + x + dx] + step);
    }
  };
  // First from one corner to the other, then back.
  for (const int to : {1, -1}) {
    for (int j = 0; j < height; ++j) {
      for (int i = 0; i < width; ++i) {
        const int x = to > 0 ? i : width - 1 - i;
        const int y = to > 0 ? j : height - 1 - j;
        lower(x, y, -to, 0, x_step);
        lower(x, y, 0, -to, y_step);
        lower(x, y, -to, -to, diagonal);
        lower(x, y, to, -to, diagonal);
      }
    }
  }
  return distance;
}

struct Offset {
  int x, y;
};

std::vector<Offset> window(const Vec3& spacing) {
  const int reach_x = static_cast<int>(kWindow / spacing.x);
  const int reach_y = static_cast<int>(kWindow / spacing.y);
  std::vector<Offset> offsets;
  for (int y = -reach_y; y <= reach_y; ++y) {
    for (int x = -reach_x; x <= reach_x; ++x) {
      if (std::hypot(static_cast<float>(x) * spacing.x, static_cast<float>(y) * spacing.y) <=
          kWindow) {
        offsets.push_back({x, y});
      }
    }
  }
  return offsets;
}

/// The mean around a voxel of what differs from it by less than `tolerance`; no metal.
float mean_around(const Volume& volume, const IVec3& at, const std::vector<Offset>& offsets,
                  float tolerance, float metal) {
  const float own = volume.at(at.x, at.y, at.z);
  float sum = 0;
  float weights = 0;
  for (const Offset& offset : offsets) {
    const int x = at.x + offset.x;
    const int y = at.y + offset.y;
    if (x < 0 || y < 0 || x >= volume.dims.x || y >= volume.dims.y) {
      continue;
    }
    const float value = volume.at(x, y, at.z);
    const float unlike = (value - own) / tolerance;
    const float alike = value < metal ? std::max(1 - unlike * unlike, 0.0f) : 0.0f;
    sum += alike * alike * value;
    weights += alike * alike;
  }
  return sum / weights;  // the voxel itself has weight 1
}

void soften_slice(const Volume& volume, int z, float metal, const std::vector<Offset>& offsets,
                  float* slice) {
  const std::vector<float> distance = distances(volume, z, metal);
  for (int y = 0; y < volume.dims.y; ++y) {
    for (int x = 0; x < volume.dims.x; ++x) {
      const size_t i = static_cast<size_t>(y) * volume.dims.x + x;
      const float strength = 1 - distance[i] / kStreakReach;
      if (strength > 0 && strength < 1) {
        const float mean = mean_around(volume, {x, y, z}, offsets, strength * kMostUnlike, metal);
        slice[i] += strength * (mean - slice[i]);
      }
    }
  }
}

}  // namespace

MetalSoftening soften_metal(Volume& volume, float least) {
  const size_t slice = static_cast<size_t>(volume.dims.x) * volume.dims.y;
  const float pixel = volume.spacing.x * volume.spacing.y;
  std::vector<size_t> metal(static_cast<size_t>(volume.dims.z));
  parallel_for(metal.size(), 1, [&](size_t z, size_t) {
    for (size_t i = z * slice; i < (z + 1) * slice; ++i) {
      metal[z] += volume.values[i] >= least ? 1 : 0;
    }
  });
  const auto has_metal = [&](size_t z) {
    return static_cast<float>(metal[z]) * pixel >= kLeastArea;
  };
  MetalSoftening done;
  for (size_t z = 0; z < metal.size(); ++z) {
    if (has_metal(z)) {
      ++done.slices;
      done.metal_ml += static_cast<double>(metal[z]) * pixel * volume.spacing.z / 1000;
    }
  }
  if (done.slices == 0) {
    return done;
  }
  const std::vector<Offset> offsets = window(volume.spacing);
  const VoxelValues::Range range = volume.values.range();
  rewrite_values(volume, value_step(range.max - range.min), [&](int z, float* out) {
    for (size_t i = 0; i < slice; ++i) {
      out[i] = volume.values[static_cast<size_t>(z) * slice + i];
    }
    if (has_metal(static_cast<size_t>(z))) {
      soften_slice(volume, z, least, offsets, out);
    }
  });
  return done;
}

}  // namespace clipgs
