#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "light/occluders.h"

namespace clipgs {

/// How far it is from the nodes of a grid to the first matter in each of a set of directions, in
/// the volume as it is uncut. What a cut keeps is convex, so that a straight ray from a kept point
/// leaves it once and for all: light comes from a direction if the ray leaves before it meets
/// matter. One set of horizons thus serves every cut.
class Horizons {
 public:
  static constexpr int kDirections = 64;
  using Directions = std::array<Vec3, kDirections>;

  /// Spread evenly over the sphere: unit, RAS.
  static const Directions& directions();

  /// `nodes`: along the longest side of the occluders' box. Throws Error for fewer than 2.
  Horizons(const Occluders& occluders, int nodes);

  const IVec3& dims() const { return dims_; }
  size_t count() const { return air_.size(); }
  float spacing() const { return spacing_; }  ///< mm between nodes
  /// The node's place in lists of all of them.
  size_t offset(const IVec3& node) const {
    return (static_cast<size_t>(node.z) * dims_.y + node.y) * dims_.x + node.x;
  }
  IVec3 node_at(size_t offset) const;
  Vec3 world_of(const IVec3& node) const { return origin_ + direction_ * (Vec3(node) * spacing_); }
  /// The node nearest to a point, within the grid.
  IVec3 nearest(const Vec3& world) const;

  /// Whether a node lies in air: what is in matter sees nothing.
  bool in_air(size_t node) const { return air_[node] != 0; }
  /// Distance to the first matter, mm, or kNever.
  float distance(size_t node, int direction) const {
    return distances_[node * kDirections + static_cast<size_t>(direction)];
  }

  /// Calls use(node, weight) for the nodes in air around a point, trilinear, with weights that add
  /// up to 1; for none where all are in matter.
  template <typename Use>
  void interpolate(const Vec3& world, const Use& use) const {
    // So little that nodes at distance 0 count only where no others do.
    constexpr float kLeast = 1e-4f;
    const Vec3 at =
        glm::clamp(((world - origin_) * direction_) / spacing_, Vec3(0), Vec3(dims_ - 1));
    const IVec3 low = glm::min(IVec3(at), glm::max(dims_ - 2, IVec3(0)));
    const Vec3 t = at - Vec3(low);
    std::array<size_t, 8> nodes{};
    std::array<float, 8> weights{};
    float sum = 0;
    for (size_t corner = 0; corner < 8; ++corner) {
      const IVec3 step(corner & 1, (corner >> 1) & 1, corner >> 2);
      nodes[corner] = offset(glm::min(low + step, dims_ - 1));
      if (in_air(nodes[corner])) {
        const Vec3 weight = glm::mix(1.0f - t, t, Vec3(step));
        weights[corner] = weight.x * weight.y * weight.z + kLeast;
        sum += weights[corner];
      }
    }
    for (size_t corner = 0; corner < 8; ++corner) {
      if (weights[corner] > 0) {
        use(nodes[corner], weights[corner] / sum);
      }
    }
  }

 private:
  IVec3 dims_{0};
  float spacing_ = 1;
  Mat3 direction_{1};
  Vec3 origin_{0};
  std::vector<std::uint8_t> air_;
  std::vector<float> distances_;
};

}  // namespace clipgs
