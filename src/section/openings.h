#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "light/cut_light.h"
#include "light/empty_space.h"

#include "core/cut.h"
#include "section/section.h"
#include "section/section_light.h"

namespace clipgs {

/// What a ray meets behind an opening.
struct Wall {
  Vec3 position;     ///< RAS mm
  Vec3 normal;       ///< unit, RAS, towards the camera
  Vec3 reflectance;  ///< linear RGB
};

/// What a cut opens (method.md §8): walls of lungs, bowel or the skull behind a gap of a face,
/// drawn from the section's volume and lit by what the cut lets in. Made once of a section, whose
/// walls it finds and lights under any cut.
class Openings {
 public:
  explicit Openings(const Section& section);

  /// Whether walls are drawn: matter must be opaque within a voxel or two. Light that goes on
  /// through glass or crystal is the splats'.
  bool drawn() const { return opaque_; }

  const CutLight& light() const { return light_; }
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
  Openings(const Section& section, const SurfaceScan& scan);

  FaceMaterial material_of(float code) const;

  std::array<FaceMaterial, ValueCurve::kCodes> materials_;
  EmptySpace empty_space_;
  bool opaque_;
  CutLight light_;
};

/// The walls that one cut opens, lit.
class OpenedLight {
 public:
  OpenedLight(const Openings& openings, const Cut& cut);

  /// What a wall radiates, linear RGB before exposure.
  Vec3 radiance(const Wall& wall) const;

 private:
  const Openings& openings_;
  std::vector<Vec3> solution_;
};

}  // namespace clipgs
