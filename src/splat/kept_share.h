#pragma once

#include <array>
#include <vector>

#include "core/camera.h"
#include "core/cut.h"
#include "splat/gaussians.h"

namespace clipgs {

/// How much of a pixel sees anything at all of a body that a cut keeps (method.md §3). Where a
/// plane is seen along itself it ends what all splats there show, at the same line; each cut alone,
/// half covers of several pile up, and the picture reaches a pixel too far.
class KeptShare {
 public:
  static constexpr float kMargin = 3;  ///< px that splats may reach out of the hull of their means

  KeptShare() = default;
  /// Of what is between the near and the far end of the Gaussians' hull on a pixel's ray. A pixel
  /// at a plane's line is covered as a straight edge covers it.
  KeptShare(const Camera& camera, const Cut& cut, const Gaussians& body);

  /// Whether that is 1 in all of the picture.
  bool is_whole() const { return edges_.empty(); }
  /// Of pixel (x, y), 0 … 1.
  float at(int x, int y) const;

 private:
  /// What a plane keeps of a pixel at depth z: (x, y, 1)·along + near/z, 0 at the plane's line, a
  /// pixel 1.
  struct Edge {
    Vec3 along;
    float near;
  };
  /// The planes across one direction of the hull, at depths between low and high over (x, y,
  /// 1)·along.
  struct Slab {
    Vec3 along;
    float low;
    float high;
  };
  std::vector<Edge> edges_;
  float margin_ = 0;  // of a depth, that splats reach out of the hull of their means
  std::vector<Slab> slabs_;
};

}  // namespace clipgs
