#pragma once

#include <array>
#include <vector>

#include "core/camera.h"
#include "core/cut.h"

namespace clipgs {

/// How much of a pixel sees anything at all of a body that a cut keeps (method.md §3). Where a
/// plane is seen along itself it ends what all splats there show, at the same line; each cut alone,
/// half covers of several pile up, and the picture reaches a pixel too far.
class KeptShare {
 public:
  KeptShare() = default;
  /// `body`: around all that is drawn, world space; of radius 0 nothing is known, and all is whole.
  /// A pixel at a plane's line is covered as a straight edge covers it.
  KeptShare(const Camera& camera, const Cut& cut, const Sphere& body);

  /// Whether that is 1 in all of the picture.
  bool is_whole() const { return edges_.empty(); }
  /// Of pixel (x, y), 0 … 1.
  float at(int x, int y) const;

 private:
  /// Linear functions of the pixel: of what a plane keeps at the body's near end and its far end.
  using Edge = std::array<Vec3, 2>;
  std::vector<Edge> edges_;
};

}  // namespace clipgs
