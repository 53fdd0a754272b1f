#include "volume/distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/parallel.h"

namespace clipgs {
namespace {

/// Squared distances, known of the axes before, along one more: of each line the least of what its
/// voxels have and how far they are.
void add_axis(const IVec3& dims, const Vec3& spacing, int axis, float most,
              std::vector<float>& squares) {
  const size_t strides[] = {1, static_cast<size_t>(dims.x), static_cast<size_t>(dims.x) * dims.y};
  const size_t stride = strides[axis];
  const auto length = static_cast<size_t>(dims[axis]);
  const size_t reach = std::min(static_cast<size_t>(most / spacing[axis]), length - 1);
  parallel_for(squares.size() / length, 256, [&](size_t begin, size_t end) {
    std::vector<float> line(length);
    for (size_t i = begin; i < end; ++i) {
      float* const first = &squares[i / stride * stride * length + i % stride];
      for (size_t k = 0; k < length; ++k) {
        line[k] = first[k * stride];
      }
      for (size_t k = 0; k < length; ++k) {
        float& least = first[k * stride];
        for (size_t step = 1; step <= reach; ++step) {
          const float along = static_cast<float>(step) * spacing[axis];
          const float square = along * along;
          if (square >= least) {
            break;
          }
          least = std::min({least, k >= step ? line[k - step] + square : least,
                            k + step < length ? line[k + step] + square : least});
        }
      }
    }
  });
}

}  // namespace

std::vector<float> distances_to(const IVec3& dims, const Vec3& spacing, const BitMask& mask,
                                float most) {
  std::vector<float> distances(mask.size());
  for (size_t i = 0; i < distances.size(); ++i) {
    distances[i] = mask[i] ? 0 : most * most;
  }
  for (int axis = 0; axis < 3; ++axis) {
    add_axis(dims, spacing, axis, most, distances);
  }
  std::ranges::for_each(distances, [](float& value) { value = std::sqrt(value); });
  return distances;
}

}  // namespace clipgs
