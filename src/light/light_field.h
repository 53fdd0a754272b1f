#pragma once

#include <array>
#include <vector>

#include "light/horizons.h"

#include "core/cut.h"
#include "volume/preset.h"

namespace clipgs {

/// Light of directions by its moments, which are spherical harmonics up to degree 2: of radiance
/// L(ω) the integrals of L, L·ω and L·ωωᵀ over the sphere, divided by 4π.
struct Radiance {
  Vec3 mean{0};
  std::array<Vec3, 3> first{};   ///< along x, y, z
  std::array<Vec3, 6> second{};  ///< xx, yy, zz, xy, yz, zx

  /// Adds light from one unit direction; `power` is the mean of what is added.
  void add(const Vec3& power, const Vec3& direction);
  /// What a white Lambert surface with this unit normal radiates: (1/π)·∫ L·max(0, n·ω) dω, as far
  /// as degree 2 tells it, 1 % of most light and a sixteenth of a point's (Ramamoorthi and Hanrahan
  /// 2001); never less than nothing.
  Vec3 reflected(const Vec3& normal) const;
};

struct LightFieldOptions {
  int bounces = 4;  ///< from wall to wall; 0: direct light alone
};

/// The light of the sky and of the key lights at any point in the air of what a cut keeps, and what
/// walls throw back: how much a plane lets in. Key lights are as wide as the directions are apart.
/// The same at any number of threads.
class LightField {
 public:
  LightField(const Horizons& horizons, const Occluders& occluders, const LightRig& rig,
             const Cut& cut, const LightFieldOptions& options = {});

  /// What a white Lambert surface at a point (RAS mm) with this unit normal radiates, linear RGB.
  Vec3 reflected(const Vec3& world, const Vec3& normal) const;

 private:
  using Field = std::vector<Radiance>;

  /// What direct light is at each node.
  Field direct_light(const LightRig& rig, const Cut& cut);
  /// What walls that show `light` add to it.
  void find_walls(const Occluders& occluders);
  void add_bounce(const Field& light, Field& sum) const;
  bool visible(size_t node, size_t direction) const {
    return visible_[node * Horizons::kDirections + direction] != 0;
  }

  /// Of one direction from a node, where it meets matter.
  struct Wall {
    size_t before;  ///< the node in air next to it
    Vec3 albedo;
    size_t direction;
  };

  const Horizons& horizons_;
  std::vector<std::uint8_t> visible_;
  std::vector<Wall> walls_;
  std::vector<size_t> first_wall_;  ///< of each node, and the end
  Field field_;
};

}  // namespace clipgs
