#pragma once

#include <span>
#include <vector>

#include "light/cut_light.h"
#include "light/empty_space.h"

#include "section/section.h"

namespace clipgs {

/// Where a section is empty; blocks that interpolation reaches the air around the body from are
/// marked, and those at sides at which the volume does not end in matter.
EmptySpace find_empty_space(const Section& section);

/// The matter of a section that stands in the light: at most `size` samples along each side, each
/// the mean of the voxels around it.
Occluders make_occluders(const Section& section, int size);

/// Where matter of a section begins.
struct SurfaceScan {
  /// Evenly spread over the surfaces, with what a ray that meets them straight would see.
  std::vector<SurfacePoint> points;
  /// Of the matter, by volume, what takes less than half of the light in a voxel, 0…1.
  float translucent = 0;
};
/// `all`: points at every voxel of a surface, not only as many as its light needs.
SurfaceScan scan_surfaces(const Section& section, bool all = false);

/// Light under any cut of a section.
CutLight make_cut_light(const Section& section, std::span<const SurfacePoint> points,
                        const LightRig& rig);

}  // namespace clipgs
