#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// How far rays may leap through a grid of voxels without missing matter: for blocks of kBlock³
/// voxels.
class EmptySpace {
 public:
  static constexpr int kBlock = 2;
  /// A mark of blocks, for whoever makes them.
  static constexpr std::uint8_t kAround = 128;

  /// What is known of a block of voxels.
  struct Block {
    bool may_have_matter = false;
    bool around = false;
  };

  /// `look(low, high)` says what is among the voxels from `low` to `high`, inclusive: those of a
  /// block and those that interpolation reaches from there. It is called on many threads.
  EmptySpace(const IVec3& voxels,
             const std::function<Block(const IVec3& low, const IVec3& high)>& look);

  const IVec3& dims() const { return dims_; }  ///< blocks
  /// [nz, ny, nx]: in the lower bits how many blocks lie, along every axis, between this one and
  /// the next that may have matter, and one more: what is nearer is empty. 0: this one may have
  /// matter. kAround is set where `look` said so.
  const std::vector<std::uint8_t>& blocks() const { return blocks_; }

  bool is_around(const Vec3& index) const { return (block_at(index) & kAround) != 0; }

  /// How far a ray may go from an index without missing matter, in units in which it runs `stride`
  /// voxels; 0 where there may be matter.
  float leap(const Vec3& index, const Vec3& stride) const;

 private:
  IVec3 place_of(const Vec3& index) const {
    return glm::clamp(IVec3(index) / kBlock, IVec3(0), dims_ - 1);
  }
  std::uint8_t block_at(const Vec3& index) const {
    const IVec3 at = place_of(index);
    return blocks_[(static_cast<size_t>(at.z) * dims_.y + at.y) * dims_.x + at.x];
  }

  IVec3 dims_;
  std::vector<std::uint8_t> blocks_;
};

}  // namespace clipgs
