#include "light/empty_space.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"

namespace clipgs {
namespace {

/// Chebyshev distances to the nearest 0, along one axis after another, of what is 0 or the most.
void spread(std::vector<std::uint8_t>& distances, const IVec3& dims) {
  const std::array<size_t, 3> strides = {1, static_cast<size_t>(dims.x),
                                         static_cast<size_t>(dims.x) * dims.y};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = distances;
    parallel_for(distances.size(), size_t{1} << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const int at = static_cast<int>(i / strides[axis]) % dims[axis];
        int least = before[i];
        for (int k = 1; k < least; ++k) {
          const size_t away = static_cast<size_t>(k) * strides[axis];
          if (at >= k) {
            least = std::min(least, std::max<int>(k, before[i - away]));
          }
          if (at + k < dims[axis]) {
            least = std::min(least, std::max<int>(k, before[i + away]));
          }
        }
        distances[i] = static_cast<std::uint8_t>(least);
      }
    });
  }
}

}  // namespace

EmptySpace::EmptySpace(const IVec3& voxels,
                       const std::function<Block(const IVec3& low, const IVec3& high)>& look)
    : dims_((voxels + kBlock - 1) / kBlock) {
  constexpr int kMost = 63;  // blocks: farther is as good as here
  blocks_.assign(static_cast<size_t>(dims_.x) * dims_.y * dims_.z, kMost);
  std::vector<std::uint8_t> around(blocks_.size(), 0);
  parallel_for(static_cast<size_t>(dims_.z), 1, [&](size_t z, size_t) {
    for (int y = 0; y < dims_.y; ++y) {
      for (int x = 0; x < dims_.x; ++x) {
        const IVec3 first = IVec3(x, y, z) * kBlock;
        const Block block =
            look(glm::max(first - 1, IVec3(0)), glm::min(first + kBlock, voxels - 1));
        const size_t at = (z * dims_.y + static_cast<size_t>(y)) * dims_.x + static_cast<size_t>(x);
        around[at] = block.around ? kAround : 0;
        if (block.may_have_matter) {
          blocks_[at] = 0;
        }
      }
    }
  });
  spread(blocks_, dims_);
  for (size_t i = 0; i < blocks_.size(); ++i) {
    blocks_[i] |= around[i];
  }
}

float EmptySpace::leap(const Vec3& index, const Vec3& stride) const {
  constexpr float kBeyond = 0.01f;  // voxels: into the next block
  const IVec3 block = place_of(index);
  const int distance = block_at(index) & ~kAround;
  if (distance == 0) {
    return 0;
  }
  const Vec3 low((block - (distance - 1)) * kBlock);
  const Vec3 high((block + distance) * kBlock);
  float leave = 1e9f;
  for (int k = 0; k < 3; ++k) {
    if (stride[k] != 0) {
      const float side = stride[k] > 0 ? high[k] + kBeyond : low[k] - kBeyond;
      leave = std::min(leave, (side - index[k]) / stride[k]);
    }
  }
  return std::max(leave, kBeyond / glm::length(stride));
}

}  // namespace clipgs
