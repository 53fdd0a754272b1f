#pragma once

#include "volume/label_looks.h"
#include "volume/transfer_function.h"
#include "volume/volume.h"

namespace clipgs {

/// Where the matter is that a transfer function and labels show, in world space (RAS mm). Specks
/// far from the rest do not count. Gradient opacity is not asked: what it leaves of matter is
/// mostly its boundary, so that the hull is much the same, or a little too large.
struct VisibleMatter {
  Box bounds;
  Sphere sphere;           ///< what cameras frame
  std::vector<Vec3> hull;  ///< points whose convex hull is the matter's

  /// Interval of normal·x over the matter.
  Vec2 extent(const Vec3& normal) const;
};

/// Throws Error if they show nothing of the volume.
VisibleMatter visible_matter(const Volume& volume, const TransferFunction& transfer,
                             const LabelLooks& labels = {});

}  // namespace clipgs
