#pragma once

#include <vector>

#include "core/cut.h"
#include "core/geometry.h"

namespace clipgs {

/// The matter that stands in the light, on a coarse grid.
struct Occluders {
  IVec3 dims{0};
  float spacing = 1;              ///< mm between samples, along every axis
  Mat3 direction{1};              ///< columns: unit RAS directions of the index axes (a rotation)
  Vec3 origin{0};                 ///< RAS mm of sample (0, 0, 0)
  std::vector<float> extinction;  ///< [nz, ny, nx], 1/mm
  std::vector<Vec3> albedo;       ///< [nz, ny, nx]: what matter there reflects, linear RGB

  size_t offset(const IVec3& sample) const {
    return (static_cast<size_t>(sample.z) * dims.y + sample.y) * dims.x + sample.x;
  }
  Vec3 index_from_world(const Vec3& world) const {
    return ((world - origin) * direction) / spacing;
  }
  Vec3 world_from_index(const Vec3& index) const { return origin + direction * (index * spacing); }
  /// Trilinear extinction at an index; beyond the grid there is nothing.
  float extinction_at(const Vec3& index) const;
  /// Albedo of the sample nearest to a point.
  const Vec3& albedo_at(const Vec3& world) const;
};

/// Of rays that meet nothing, or never leave.
constexpr float kNever = 1e9f;

/// Distance from a point (RAS mm) along a unit direction at which half of the light is gone, mm;
/// kNever if that much matter does not lie there.
float horizon_distance(const Occluders& occluders, const Vec3& from, const Vec3& direction);

/// Distance at which a ray from a kept point leaves what `cut` keeps, mm; kNever if it stays.
float exit_distance(const Cut& cut, const Vec3& from, const Vec3& direction);

}  // namespace clipgs
