#include "section/field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace clipgs {
namespace {

/// Weights of `old_count` points of a line in each of `count` that share its ends.
class Tent {
 public:
  Tent(int old_count, int count)
      : last_(old_count - 1),
        step_(count > 1 ? static_cast<float>(last_) / static_cast<float>(count - 1) : 1.0f),
        radius_(std::max(1.0f, step_)) {}

  /// New point i of a line whose points are `stride` apart.
  float at(const float* line, size_t stride, int i) const {
    const float centre = static_cast<float>(i) * step_;
    const int first = std::max(0, static_cast<int>(std::ceil(centre - radius_)));
    const int last = std::min(last_, static_cast<int>(std::floor(centre + radius_)));
    float sum = 0;
    float weights = 0;
    for (int k = first; k <= last; ++k) {
      const float weight = 1 - std::abs(static_cast<float>(k) - centre) / radius_;
      sum += weight * line[static_cast<size_t>(k) * stride];
      weights += weight;
    }
    return sum / weights;
  }

 private:
  int last_;
  float step_;    // of the old grid
  float radius_;  // of the old grid
};

Field resample_axis(Field in, int axis, int count) {
  if (in.dims[axis] == count) {
    return in;
  }
  Field out;
  out.dims = in.dims;
  out.dims[axis] = count;
  out.values.resize(static_cast<size_t>(out.dims.x) * out.dims.y * out.dims.z);
  const Tent tent(in.dims[axis], count);
  size_t stride = 1;
  for (int k = 0; k < axis; ++k) {
    stride *= static_cast<size_t>(in.dims[k]);
  }
  parallel_for(static_cast<size_t>(out.dims.z), 1, [&](size_t z, size_t) {
    for (int y = 0; y < out.dims.y; ++y) {
      for (int x = 0; x < out.dims.x; ++x) {
        IVec3 line(x, y, static_cast<int>(z));
        const int i = std::exchange(line[axis], 0);
        out.values[out.offset(x, y, static_cast<int>(z))] =
            tent.at(&in.values[in.offset(line.x, line.y, line.z)], stride, i);
      }
    }
  });
  return out;
}

}  // namespace

Field resample(Field field, const IVec3& dims) {
  for (int axis = 0; axis < 3; ++axis) {
    field = resample_axis(std::move(field), axis, dims[axis]);
  }
  return field;
}

Field resample_rows(const IVec3& from, const IVec3& dims,
                    const std::function<void(int y, int z, float* row)>& read) {
  Field field;
  field.dims = {dims.x, from.y, from.z};
  field.values.resize(static_cast<size_t>(dims.x) * from.y * from.z);
  const Tent tent(from.x, dims.x);
  parallel_for(static_cast<size_t>(from.z), 1, [&](size_t z, size_t) {
    std::vector<float> row(static_cast<size_t>(from.x));
    for (int y = 0; y < from.y; ++y) {
      read(y, static_cast<int>(z), row.data());
      float* const to = &field.values[field.offset(0, y, static_cast<int>(z))];
      for (int x = 0; x < dims.x; ++x) {
        to[x] = from.x == dims.x ? row[static_cast<size_t>(x)] : tent.at(row.data(), 1, x);
      }
    }
  });
  return resample(std::move(field), dims);
}

}  // namespace clipgs
