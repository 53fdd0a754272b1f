#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "light/empty_space.h"

#include "core/geometry.h"

namespace clipgs {

/// The matter that stands in the light, on a grid of cubes.
struct Occluders {
  IVec3 dims{0};
  float spacing = 1;  ///< mm between samples, along every axis
  Mat3 direction{1};  ///< columns: unit RAS directions of the index axes (a rotation)
  Vec3 origin{0};     ///< RAS mm of sample (0, 0, 0)
  /// [nz, ny, nx]: how much of the light a voxel there takes, 0…255.
  std::vector<std::uint8_t> coverage;

  size_t offset(const IVec3& sample) const {
    return (static_cast<size_t>(sample.z) * dims.y + sample.y) * dims.x + sample.x;
  }
  Vec3 index_from_world(const Vec3& world) const {
    return ((world - origin) * direction) / spacing;
  }
  Vec3 world_from_index(const Vec3& index) const { return origin + direction * (index * spacing); }
  /// Trilinear coverage at an index, 0…255; beyond the grid there is nothing.
  float coverage_at(const Vec3& index) const;
};

/// Of rays that meet nothing, or never leave.
constexpr float kNever = 1e9f;

/// Where none of them take half of the light.
EmptySpace find_empty_space(const Occluders& occluders);

/// Distance from a point (RAS mm) along a unit direction at which matter begins (half of the light
/// is gone), mm, looked for from `start` on; kNever if there is none. `empty`: of the occluders.
float horizon_distance(const Occluders& occluders, const EmptySpace& empty, const Vec3& from,
                       const Vec3& direction, float start);

/// Distance at which a ray from a kept point leaves what all planes keep, mm; 0 from a point that
/// is not kept, kNever if the ray stays.
float exit_distance(std::span<const Plane> planes, const Vec3& from, const Vec3& direction);

}  // namespace clipgs
