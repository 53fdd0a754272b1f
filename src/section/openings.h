#pragma once

#include <optional>
#include <span>
#include <vector>

#include "light/cut_light.h"
#include "light/empty_space.h"

#include "core/cut.h"
#include "section/material_table.h"
#include "section/section.h"
#include "section/section_light.h"

namespace clipgs {

/// The first surface that a ray meets.
struct Wall {
  Vec3 position;     ///< RAS mm
  Vec3 normal;       ///< unit, RAS, towards the camera, or past it at a rim
  Vec3 reflectance;  ///< linear RGB
  float specular;    ///< weight of its gloss, 0…1, and
  float roughness;   ///< α of the GGX lobe
};

/// What a cut opens (method.md §8): walls of lungs, bowel or the skull behind a gap of a face,
/// drawn from the section's volume and lit by what the cut lets in. Made once of a section, whose
/// walls it finds and lights under any cut.
class Openings {
 public:
  explicit Openings(const Section& section);
  /// `scan`: of the section (scan_surfaces()).
  Openings(const Section& section, const SurfaceScan& scan);

  /// Whether walls are drawn: nearly all matter must be opaque within a voxel. Light that goes on
  /// through glass or skin before bone is the splats'.
  bool drawn() const { return translucent_ < kMostTranslucent; }
  /// Whether what is kept is given its outline (Outline): of glass rays would have to be followed
  /// everywhere and all the way.
  bool outlined() const { return translucent_ < kGlass; }

  const CutLight& light() const { return light_; }
  /// Light of the uncut volume under the rig that it was traced under: what splats' colours have in
  /// them.
  const std::vector<Vec3>& own_light() const { return own_light_; }
  /// Whether light is that of a surface that is lit uncut: darker ones, cavities, are drawn from
  /// the volume, and say nothing of the skin beside them.
  static bool is_lit(const Vec3& light) { return light.g >= kLit; }
  /// From now on other lights.
  void set_rig(const LightRig& rig) { light_.set_rig(rig); }
  const EmptySpace& empty_space() const { return empty_space_; }
  /// Whether nothing around an index of the section is air around the body: a gap there is an
  /// opening.
  bool is_inside(const Vec3& index) const { return !empty_space_.is_around(index); }

  /// What walls are lit by under a cut: a solution of light(). With `from`, that of another cut
  /// nearby, it takes fewer bounces and may be a little behind.
  std::vector<Vec3> solve(std::span<const Plane> planes, std::span<const Vec3> from = {}) const;

  /// The first wall of the section that this was made of along a ray (RAS mm, unit direction)
  /// between two distances, mm; nothing if there is none.
  std::optional<Wall> first_wall(const Section& section, const Vec3& eye, const Vec3& direction,
                                 float from, float to) const;

 private:
  static constexpr float kLit = 0.05f;
  // Of opaque presets' matter less than a tenth is translucent, at its surfaces, and of thin
  // vessels a quarter; of others a third or more, of those that have no surface to speak of nearly
  // all.
  static constexpr float kMostTranslucent = 0.3f;
  static constexpr float kGlass = 0.9f;

  MaterialTable materials_;
  EmptySpace empty_space_;
  float translucent_;  // share of the matter
  CutLight light_;
  std::vector<Vec3> own_light_;
};

/// The light under one cut.
class OpenedLight {
 public:
  /// `openings` must outlive it.
  OpenedLight(const Openings& openings, const Cut& cut);

  const Openings& openings() const { return openings_; }
  /// What a wall would radiate if it were white, linear RGB before exposure.
  Vec3 on(const Wall& wall) const;
  /// How much brighter the surface around a point (RAS mm) is than uncut under its own lights, of
  /// sides that `axis` points out of or into: a factor of linear RGB. 1 where there is none, or
  /// none that was lit.
  Vec3 gain(const Vec3& world, const Vec3& axis) const;

 private:
  const Openings& openings_;
  std::vector<Vec3> solution_;
};

}  // namespace clipgs
