#pragma once

#include "core/geometry.h"
#include "splat/gaussians.h"

namespace clipgs {

/// A change of frame that keeps angles: y = scale·rotation·x + translation, in double precision so
/// that a way there and back loses nothing that a float holds.
struct Similarity {
  glm::dmat3 rotation{1};  ///< proper: determinant +1
  double scale = 1;
  glm::dvec3 translation{0};

  Vec3 apply(const Vec3& x) const { return Vec3(scale * (rotation * glm::dvec3(x)) + translation); }
  Similarity inverse() const;
  /// Column-major, as GLM keeps it: matrix()[column][row].
  glm::dmat4 matrix() const;
  /// Throws Error if `matrix` is not finite, mirrors, shears or scales unevenly.
  static Similarity from_matrix(const glm::dmat4& matrix);
};

/// Scene space → world. Scene space is what files hold: the axes of 3DGS (x right, y down, z
/// forward) in metres, the patient upright and facing the viewer: x = −R, y = −S, z = −A, divided
/// by 1000. World is RAS mm.
Similarity scene_to_world();

/// The same cloud in another frame: means, log scales, rotations, and the SH coefficients, so that
/// the colour seen along a direction d before is the colour seen along rotation·d after.
Gaussians transform(const Gaussians& gaussians, const Similarity& similarity);

}  // namespace clipgs
