#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// A point where air meets matter.
struct SurfacePoint {
  Vec3 position;     ///< RAS mm
  Vec3 normal;       ///< unit, RAS, into the air
  Vec3 reflectance;  ///< linear RGB, of a Lambert surface
};

/// A grid of cubes over what is lit, and how it lies in space.
struct PatchGrid {
  IVec3 dims{0};
  float spacing = 1;  ///< mm, side of a cell
  Mat3 direction{1};  ///< columns: unit RAS directions of the index axes (a rotation)
  Vec3 origin{0};     ///< RAS mm of the middle of cell (0, 0, 0)

  size_t cells() const { return static_cast<size_t>(dims.x) * dims.y * dims.z; }
  Vec3 index_from_world(const Vec3& world) const {
    return ((world - origin) * direction) / spacing;
  }
  size_t offset(const IVec3& cell) const {
    return (static_cast<size_t>(cell.z) * dims.y + cell.y) * dims.x + cell.x;
  }
};

/// The surfaces of a volume in patches: of each cell of a grid up to six, one for each side that a
/// surface there may face (of an axis of the grid, the positive side first). Light is kept and
/// looked up by them: a wall and its back never share one, and of surfaces one close behind another
/// it is the outermost's.
class Patches {
 public:
  static constexpr int kSides = 6;
  static constexpr size_t kSamples = 8;
  static constexpr std::int32_t kNone = -1;

  Patches(const PatchGrid& grid, std::span<const SurfacePoint> scanned);

  const PatchGrid& grid() const { return grid_; }
  /// Means of the points of each patch, in the order of cells and sides.
  const std::vector<SurfacePoint>& all() const { return patches_; }
  size_t count() const { return patches_.size(); }
  /// Index of the patch of a cell that faces a side, or kNone.
  std::int32_t at(size_t cell, int side) const {
    return lookup_[cell * kSides + static_cast<size_t>(side)];
  }
  /// One of a few points of a patch, spread over it: where its light comes to.
  const SurfacePoint& sample(size_t patch, size_t i) const {
    return samples_[patch * kSamples + i % kSamples];
  }
  size_t cell_of(size_t patch) const { return places_[patch] / kSides; }
  int side_of(size_t patch) const { return static_cast<int>(places_[patch] % kSides); }

  /// The patch that a ray along `direction` meets near a point of a surface; kNone if there is
  /// none that faces it.
  std::int32_t met_by(const Vec3& world, const Vec3& direction) const;

  /// Calls use(patch, weight) for the patches around a point of a surface with unit `normal`:
  /// trilinear between cells, and by the squares of the normal's components between sides. Weights
  /// add up to 1 or less where patches are missing.
  template <typename Use>
  void interpolate(const Vec3& world, const Vec3& normal, const Use& use) const {
    const Vec3 n = normal * grid_.direction;
    const Vec3 at = glm::clamp(grid_.index_from_world(world), Vec3(0), Vec3(grid_.dims - 1));
    const IVec3 low = glm::min(IVec3(at), glm::max(grid_.dims - 2, IVec3(0)));
    const Vec3 t = at - Vec3(low);
    for (int corner = 0; corner < 8; ++corner) {
      const IVec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
      const size_t cell = grid_.offset(glm::min(low + step, grid_.dims - 1));
      const Vec3 weight = glm::mix(1.0f - t, t, Vec3(step));
      const float near = weight.x * weight.y * weight.z;
      for (int axis = 0; axis < 3; ++axis) {
        const std::int32_t patch = this->at(cell, 2 * axis + (n[axis] < 0 ? 1 : 0));
        if (patch != kNone && near > 0) {
          use(static_cast<size_t>(patch), near * n[axis] * n[axis]);
        }
      }
    }
  }

 private:
  PatchGrid grid_;
  std::vector<SurfacePoint> patches_;
  std::vector<SurfacePoint> samples_;  // [patches, kSamples]
  std::vector<std::uint32_t> places_;  // cell · kSides + side
  std::vector<std::int32_t> lookup_;   // [cells, kSides]
};

}  // namespace clipgs
