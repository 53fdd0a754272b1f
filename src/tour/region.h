#pragma once

#include <optional>

#include "tour/mark.h"

namespace clipgs {

/// Of the values within a region of a face.
struct RegionValues {
  double mean = 0;
  double deviation = 0;  ///< standard, of the samples
};

/// mm². Of an outline that crosses itself, what goes around clockwise counts less.
double region_area(const Mark& region);

/// What the volume has within a region: samples half a voxel apart, closer in small ones. What lies
/// outside the body does not count; none where nothing does. The twin of web/src/model/region.ts.
std::optional<RegionValues> region_values(const Mark& region, const Section& section);

}  // namespace clipgs
