#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/geometry.h"
#include "core/parallel.h"
#include "volume/volume.h"

namespace clipgs {

/// Where a fine voxel lies among the scanned ones along an axis.
struct Between {
  int low;
  int high;
  float t;  // from low to high
};

/// Weights of the four scanned voxels around a fine one along an axis (Catmull and Rom 1974).
struct Cubic {
  Cubic(const Between& at, int count)
      : places{std::max(at.low - 1, 0), at.low, at.high, std::min(at.high + 1, count - 1)},
        weights{0.5f * at.t * (at.t * (2 - at.t) - 1), 0.5f * (at.t * at.t * (3 * at.t - 5) + 2),
                0.5f * at.t * (at.t * (4 - 3 * at.t) + 1), 0.5f * at.t * at.t * (at.t - 1)} {}

  std::array<int, 4> places;
  std::array<float, 4> weights;
};

/// The scanned grid, and the fine one between its voxels.
struct FineGrid {
  FineGrid(const Volume& volume, const IVec3& given)
      : coarse(volume.dims),
        factors(given),
        fine((volume.dims - 1) * given + 1),
        spacing(volume.spacing / Vec3(given)) {
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < fine[k]; ++i) {
        const int low = std::min(i / factors[k], coarse[k] - 1);
        between[k].push_back({low, std::min(low + 1, coarse[k] - 1),
                              static_cast<float>(i % factors[k]) / static_cast<float>(factors[k])});
        cubic[k].emplace_back(between[k].back(), coarse[k]);
      }
    }
  }

  size_t coarse_at(int x, int y, int z) const {
    return (static_cast<size_t>(z) * coarse.y + y) * coarse.x + x;
  }
  size_t fine_at(int x, int y, int z) const {
    return (static_cast<size_t>(z) * fine.y + y) * fine.x + x;
  }
  size_t coarse_count() const { return coarse_at(0, 0, coarse.z); }
  size_t fine_count() const { return fine_at(0, 0, fine.z); }

  /// Trilinear value of a field of scanned voxels (floats, or VoxelValues) at a fine voxel.
  template <typename Field>
  float interpolate(const Field& field, int x, int y, int z) const {
    const auto [x0, x1, tx] = between[0][static_cast<size_t>(x)];
    const auto [y0, y1, ty] = between[1][static_cast<size_t>(y)];
    const auto [z0, z1, tz] = between[2][static_cast<size_t>(z)];
    const auto row = [&, x0 = x0, x1 = x1, tx = tx](int at_y, int at_z) {
      const size_t first = coarse_at(0, at_y, at_z);
      const float low = field[first + static_cast<size_t>(x0)];
      return low + tx * (field[first + static_cast<size_t>(x1)] - low);
    };
    const float near = row(y0, z0) + ty * (row(y1, z0) - row(y0, z0));
    const float far = row(y0, z1) + ty * (row(y1, z1) - row(y0, z1));
    return near + tz * (far - near);
  }

  /// The same by Catmull-Rom splines, whose slopes have no steps.
  template <typename Field>
  float interpolate_smoothly(const Field& field, int x, int y, int z) const {
    const Cubic& along_x = cubic[0][static_cast<size_t>(x)];
    const Cubic& along_y = cubic[1][static_cast<size_t>(y)];
    const Cubic& along_z = cubic[2][static_cast<size_t>(z)];
    float sum = 0;
    for (size_t k = 0; k < 4; ++k) {
      for (size_t j = 0; j < 4; ++j) {
        const size_t row = coarse_at(0, along_y.places[j], along_z.places[k]);
        float of_row = 0;
        for (size_t i = 0; i < 4; ++i) {
          of_row += along_x.weights[i] * field[row + static_cast<size_t>(along_x.places[i])];
        }
        sum += along_y.weights[j] * along_z.weights[k] * of_row;
      }
    }
    return sum;
  }

  IVec3 coarse;
  IVec3 factors;
  IVec3 fine;
  Vec3 spacing;  // mm, of fine voxels
  std::array<std::vector<Between>, 3> between;
  std::array<std::vector<Cubic>, 3> cubic;
};

/// Calls body(x, y, z) for every voxel of a grid, slices in parallel.
template <typename Body>
void for_each_voxel(const IVec3& dims, const Body& body) {
  parallel_for(static_cast<size_t>(dims.z), 1, [&](size_t z, size_t) {
    for (int y = 0; y < dims.y; ++y) {
      for (int x = 0; x < dims.x; ++x) {
        body(x, y, static_cast<int>(z));
      }
    }
  });
}

}  // namespace clipgs
