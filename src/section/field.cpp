#include "section/field.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace clipgs {
namespace {

Field resample_axis(const Field& in, int axis, int count) {
  if (in.dims[axis] == count) {
    return in;
  }
  Field out;
  out.dims = in.dims;
  out.dims[axis] = count;
  out.values.resize(static_cast<size_t>(out.dims.x) * out.dims.y * out.dims.z);
  const float step =
      count > 1 ? static_cast<float>(in.dims[axis] - 1) / static_cast<float>(count - 1) : 1.0f;
  const float radius = std::max(1.0f, step);
  size_t stride = 1;
  for (int k = 0; k < axis; ++k) {
    stride *= static_cast<size_t>(in.dims[k]);
  }
  parallel_for(static_cast<size_t>(out.dims.z), 1, [&](size_t z, size_t) {
    for (int y = 0; y < out.dims.y; ++y) {
      for (int x = 0; x < out.dims.x; ++x) {
        IVec3 at(x, y, static_cast<int>(z));
        const float centre = static_cast<float>(at[axis]) * step;
        const int first = std::max(0, static_cast<int>(std::ceil(centre - radius)));
        const int last = std::min(in.dims[axis] - 1, static_cast<int>(std::floor(centre + radius)));
        at[axis] = 0;
        const float* row = &in.values[in.offset(at.x, at.y, at.z)];
        float sum = 0;
        float weights = 0;
        for (int i = first; i <= last; ++i) {
          const float weight = 1 - std::abs(static_cast<float>(i) - centre) / radius;
          sum += weight * row[static_cast<size_t>(i) * stride];
          weights += weight;
        }
        out.values[out.offset(x, y, static_cast<int>(z))] = sum / weights;
      }
    }
  });
  return out;
}

}  // namespace

Field resample(Field field, const IVec3& dims) {
  for (int axis = 0; axis < 3; ++axis) {
    field = resample_axis(field, axis, dims[axis]);
  }
  return field;
}

}  // namespace clipgs
