#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "light/occluders.h"
#include "light/patches.h"

#include "volume/light_rig.h"

namespace clipgs {

/// Light under any cut (method.md §8). What a cut keeps is convex, so that a straight ray from a
/// kept point leaves it once and for all: light comes along a ray if it leaves before it meets
/// matter in the volume as it is uncut. From every patch rays are therefore followed once, to their
/// *horizons*; a cut asks only for the nearest plane.
class CutLight {
 public:
  static constexpr int kSkyRays = 48;  ///< from a patch, spread as the cosine is
  static constexpr int kKeyRays = 4;   ///< to each key light's disc

  /// `lift`: mm above a surface from which its light is looked for, as the path tracer does.
  CutLight(Occluders occluders, Patches patches, const LightRig& rig, float lift);

  /// From now on other lights: only rays to keys are followed again.
  void set_rig(const LightRig& rig);

  const Patches& patches() const { return patches_; }

  /// What a white Lambert surface at every patch radiates under a cut, linear RGB: direct light of
  /// sky and keys, and what the other patches throw back, `bounces` times. `from`: bounces start
  /// from this solution (of another plane, say) instead of direct light. The same at any number of
  /// threads.
  std::vector<Vec3> solve(std::span<const Plane> planes, int bounces,
                          std::span<const Vec3> from = {}) const;

 private:
  struct Horizon {
    float distance;
    std::int32_t patch;  // that is met there
  };

  /// Direct light under a cut, and what the rays meet that it does not come along.
  struct Direct {
    std::vector<Vec3> light;           // of each patch
    std::vector<std::int32_t> met;     // patches
    std::vector<std::uint32_t> first;  // of those met from each patch, and the end
  };
  Direct direct(std::span<const Plane> planes) const;

  Vec3 origin_of(const SurfacePoint& point) const { return point.position + lift_ * point.normal; }
  template <typename Use>
  void each_sky_ray(size_t patch, const Use& use) const;
  /// Where ray i of those to all keys begins.
  const SurfacePoint& key_sample(size_t patch, size_t i) const {
    return patches_.sample(patch, i * (Patches::kSamples / kKeyRays));
  }

  Occluders occluders_;
  EmptySpace empty_;
  Patches patches_;
  LightRig rig_;
  float lift_;
  std::vector<Horizon> sky_;          // [patches, kSkyRays]
  std::vector<float> keys_;           // [patches, keys, kKeyRays]: distances
  std::vector<Vec3> key_directions_;  // [keys, kKeyRays]
};

/// What a white surface radiates at a point (RAS mm) with this unit normal, of a solution.
Vec3 light_at(const Patches& patches, std::span<const Vec3> solution, const Vec3& world,
              const Vec3& normal);

}  // namespace clipgs
