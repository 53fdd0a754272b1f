#pragma once

#include <span>
#include <vector>

#include "cinema/dataset.h"
#include "cinema/visible_matter.h"

namespace clipgs {

/// What other splits have to keep away from: frames whose planes and views nothing else may come
/// near, so that a model cannot have learnt their pictures by heart.
class HeldOut {
 public:
  static constexpr float kLeastStep = 0.01f;    ///< between planes, of the matter's extent
  static constexpr float kLeastTurn = 0.0873f;  ///< between views, radians: 5°

  /// `views`: how many will be added in all. Of very many the least turn becomes less, so that half
  /// of all directions are left. `mirrored`: views that the axis mirrors count as near, too.
  HeldOut(const VisibleMatter& matter, const Vec3& axis, bool mirrored, size_t views);

  void add(std::span<const Frame> frames);

  /// Whether a camera in this unit direction from the matter's centre would see what is held out.
  bool near(const Vec3& direction) const;
  /// Whether a plane comes nearer anywhere in the matter's sphere than kLeastStep of the extent.
  bool near(const Plane& plane) const;

  /// Directions spread evenly over the part of the sphere that is left.
  std::vector<Vec3> spread_directions(int count, const Mat3& rotation) const;

  /// The height, as a share of the extent along the axis, at `share` (0…1) of what is left of
  /// `range` to planes across the axis.
  float free_height(const Vec2& range, float share) const;

 private:
  const VisibleMatter& matter_;
  Vec3 axis_;
  bool mirrored_;
  float least_cosine_;
  std::vector<Vec3> directions_;
  std::vector<Plane> planes_;
};

/// Unit direction from the matter's centre to the frame's camera.
Vec3 view_of(const Frame& frame, const VisibleMatter& matter);

/// The largest distance between two planes within a sphere, mm, whichever side they keep.
float plane_distance(const Plane& a, const Plane& b, const Sphere& sphere);

}  // namespace clipgs
