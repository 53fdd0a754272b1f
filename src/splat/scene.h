#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/volume_look.h"
#include "splat/face_gain.h"
#include "splat/gaussians.h"

namespace clipgs {

constexpr int kMaxStates = 65536;  ///< layers have 16 bits

/// Bytes that a title may have: 500 characters of any script.
inline constexpr size_t kMostTitle = 8192;

/// States of a uniaxial cut, as many as ClipGS-VR has.
constexpr int kDefaultStates = 200;

/// Positions that a uniaxial cut steps through (ClipGS-VR): state k's plane is axis·x = first +
/// k·spacing, mm along Scene::axis, and keeps one side of it.
struct PlaneStates {
  int count = 0;  ///< 0: the scene has none
  float first = 0;
  float spacing = 1;        ///< > 0
  bool keeps_below = true;  ///< what lies below the plane, against the axis, stays

  /// Those of a scene that has none: at the upper ends of 200 equal parts of `extent`, the interval
  /// of axis·x over the visible matter, keeping what is below, as baked ones (defaultStates of
  /// web/src/model/states.ts).
  static PlaneStates over(const Vec2& extent) {
    constexpr float kLeastSpacing = 1e-3f;  // mm, of a scene that is flat
    const float spacing = std::max((extent.y - extent.x) / kDefaultStates, kLeastSpacing);
    return {kDefaultStates, extent.x + spacing, spacing, true};
  }
  float position(int k) const { return first + static_cast<float>(k) * spacing; }
  /// The state whose plane is nearest to `position`, mm along the axis.
  int nearest(float position) const {
    const float k = std::round((position - first) / spacing);
    return static_cast<int>(std::clamp(k, 0.0f, static_cast<float>(count - 1)));
  }
  /// The state whose slab, the step of the axis on the kept side of its plane, is nearest to
  /// `position`.
  int nearest_slab(float position) const {
    return nearest(keeps_below ? position + 0.5f * spacing : position - 0.5f * spacing);
  }
  /// The state whose slab a plane at `position` goes through: its own state's for the plane of a
  /// state. Below 0 or from `count` on where the plane is beyond all slabs.
  int slab_at(float position) const {
    constexpr float kSlack = 1e-3f;  // steps, for what rounding makes of a state's own plane
    const float k = (position - first) / spacing;
    return static_cast<int>(keeps_below ? std::ceil(k - kSlack) : std::floor(k + kSlack));
  }
  /// The plane of a uniaxial cut at `position`, mm along `axis`.
  Plane plane(const Vec3& axis, float position) const {
    const Plane above{axis, position};
    return keeps_below ? above.flipped() : above;
  }
};

/// An explicit Gaussian scene with what is needed to show and cut it; what a case file holds.
struct Scene {
  Gaussians gaussians;  ///< world space (RAS mm)
  Sphere sphere;        ///< bounding sphere of the visible matter: frames the camera
  Box bounds;           ///< bounding box of the visible matter
  Vec3 axis{0, 0, 1};   ///< the uniaxial cut's normal n₀
  Vec2 extent{0};       ///< interval of axis·x over the visible matter, mm
  std::string title;    ///< the user's, or usual_title(): nothing of the input's name
  std::string preset;   ///< name of the preset
  std::string created;  ///< ISO 8601 date, or empty
  VolumeLook look;      ///< of the volume that the scene was made of
  FaceGain face_gain;   ///< of the splats at a cut face
  /// The Gaussians are placed where a section has surfaces, and not trained: where those are drawn
  /// they add nothing.
  bool placed = false;
  /// Of the training that the scene is to have, the share that it has had: 0 of one that was there
  /// at once, 1 of one that is finished.
  float trained = 1;
  PlaneStates states;  ///< of the uniaxial cut
  /// The state that each Gaussian comes from, its rendering layer; empty if the scene has none.
  std::vector<std::uint16_t> layers;
};

}  // namespace clipgs
