#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// What is kept: what lies on the kept side of every plane. No plane: everything; two that face
/// each other: a slab.
class Cut {
 public:
  static constexpr size_t kMostPlanes = 6;

  Cut() = default;
  // One plane, or none, is a cut.
  Cut(std::nullopt_t) {}                                                        // NOLINT
  Cut(const Plane& plane) : planes_{plane} {}                                   // NOLINT
  Cut(const std::optional<Plane>& plane) : Cut(plane ? Cut(*plane) : Cut()) {}  // NOLINT
  /// Throws Error for more than kMostPlanes.
  explicit Cut(std::vector<Plane> planes);

  /// Opposite planes follow each other.
  std::span<const Plane> planes() const { return planes_; }
  bool empty() const { return planes_.empty(); }

 private:
  std::vector<Plane> planes_;
};

/// Whether two planes keep what is between them, or nothing: their normals are opposite.
bool are_opposite(const Plane& a, const Plane& b);

}  // namespace clipgs
