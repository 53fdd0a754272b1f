#include "volume/orient.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

/// A grid of some size, with spacing and origin of some sense.
void require_regular_grid(const StoredImage& stored, const std::string& where) {
  if (glm::any(glm::lessThan(stored.dims, IVec3(2)))) {
    throw Error("{}: {} x {} x {} voxels; at least 2 along every axis are needed", where,
                stored.dims.x, stored.dims.y, stored.dims.z);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double spacing = stored.spacing[axis];
    const bool sane = spacing > 1e-6 && spacing < 1e6 && std::abs(stored.origin[axis]) < 1e9;
    if (!sane) {  // NaN too
      throw Error("{}: its spacing or origin along axis {} makes no sense; the header is corrupt",
                  where, axis);
    }
  }
}

/// For each patient axis (R, A, S): which stored axis runs closest to it, and its sign.
struct AxisMap {
  std::array<int, 3> axis{0, 1, 2};
  std::array<int, 3> sign{1, 1, 1};
};

/// Of the 24 ways to name and turn the axes that leave a right-handed grid (a file may store a
/// mirrored one: the voxels are then put in another order, the patient stays as it is), the
/// closest.
AxisMap closest_axes(const glm::dmat3& ras) {
  constexpr int kSigns = 8;
  AxisMap best;
  double best_score = -3;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < kSigns; ++signs) {
      const std::array<int, 3> sign{(signs & 1) != 0 ? -1 : 1, (signs & 2) != 0 ? -1 : 1,
                                    (signs & 4) != 0 ? -1 : 1};
      double score = 0;
      glm::dmat3 turned;
      for (int world = 0; world < 3; ++world) {
        turned[world] = ras[order[world]] * static_cast<double>(sign[world]);
        score += turned[world][world];
      }
      if (glm::determinant(turned) > 0 && score > best_score + 1e-9) {
        best_score = score;
        best = {order, sign};
      }
    }
  } while (std::ranges::next_permutation(order).found);
  return best;
}

void require_perpendicular(const glm::dmat3& direction, const std::string& where) {
  const glm::dmat3 product = glm::transpose(direction) * direction;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!(std::abs(product[i][j] - (i == j ? 1 : 0)) < 1e-3)) {
        throw Error("{}: its axes are not perpendicular; resample it to a regular grid", where);
      }
    }
  }
}

/// Copies `channels` numbers a voxel into the new order of the axes.
template <typename T>
std::vector<T> reorder(std::vector<T> from, int channels, const IVec3& from_dims, const IVec3& dims,
                       const AxisMap& map) {
  const bool in_order = map.axis == std::array{0, 1, 2} && map.sign == std::array{1, 1, 1};
  if (from.empty() || in_order) {
    return from;
  }
  const std::array<std::ptrdiff_t, 3> from_stride{1, from_dims.x,
                                                  std::ptrdiff_t{from_dims.x} * from_dims.y};
  std::array<std::ptrdiff_t, 3> step{};
  std::ptrdiff_t start = 0;
  for (int i = 0; i < 3; ++i) {
    step[i] = from_stride[map.axis[i]] * map.sign[i];
    start += map.sign[i] < 0 ? from_stride[map.axis[i]] * (dims[i] - 1) : 0;
  }
  std::vector<T> to(from.size());
  parallel_for(static_cast<size_t>(dims.z), 1, [&](size_t begin, size_t end) {
    for (size_t z = begin; z < end; ++z) {
      size_t out = z * dims.x * dims.y * channels;
      for (int y = 0; y < dims.y; ++y) {
        std::ptrdiff_t in = start + static_cast<std::ptrdiff_t>(z) * step[2] + y * step[1];
        for (int x = 0; x < dims.x; ++x, in += step[0]) {
          for (int c = 0; c < channels; ++c) {
            to[out++] = from[static_cast<size_t>(in) * channels + c];
          }
        }
      }
    }
  });
  return to;
}

VoxelValues reorder(VoxelValues from, const IVec3& from_dims, const IVec3& dims,
                    const AxisMap& map) {
  from.rearrange([&](auto places) { return reorder(std::move(places), 1, from_dims, dims, map); });
  return from;
}

}  // namespace

Volume oriented(StoredImage stored, const std::string& where) {
  require_regular_grid(stored, where);
  require_perpendicular(stored.direction, where);
  const glm::dvec3 ras_sign(-1, -1, 1);
  glm::dmat3 ras;
  for (int i = 0; i < 3; ++i) {
    ras[i] = stored.direction[i] * ras_sign;
  }
  const AxisMap map = closest_axes(ras);

  Volume volume;
  glm::dvec3 origin = stored.origin * ras_sign;
  glm::dmat3 direction;
  for (int i = 0; i < 3; ++i) {
    const int from = map.axis[i];
    volume.dims[i] = stored.dims[from];
    volume.spacing[i] = static_cast<float>(stored.spacing[from]);
    direction[i] = ras[from] * static_cast<double>(map.sign[i]);
    if (map.sign[i] < 0) {
      origin += ras[from] * stored.spacing[from] * static_cast<double>(stored.dims[from] - 1);
    }
  }
  volume.origin = Vec3(origin);
  volume.direction = Mat3(glm::mat3_cast(glm::normalize(glm::quat_cast(direction))));
  volume.values = reorder(std::move(stored.values), stored.dims, volume.dims, map);
  volume.rgb = reorder(std::move(stored.rgb), 3, stored.dims, volume.dims, map);
  return volume;
}

}  // namespace clipgs
