#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// One channel of values on a grid, x fastest.
struct Field {
  IVec3 dims{0};
  std::vector<float> values;

  size_t offset(int x, int y, int z) const {
    return (static_cast<size_t>(z) * dims.y + y) * dims.x + x;
  }
};

/// The same box sampled by `dims` points, at least 1 along each axis: between the first and the
/// last of the old ones, by a tent as wide as the coarser of the two spacings, so that detail which
/// the new grid cannot hold is averaged, not aliased. Exact where the grids are the same.
Field resample(Field field, const IVec3& dims);

/// The same of a grid of `from` points whose rows along x read(y, z, row) writes, on any thread: as
/// floats they would take four bytes each.
Field resample_rows(const IVec3& from, const IVec3& dims,
                    const std::function<void(int y, int z, float* row)>& read);

}  // namespace clipgs
