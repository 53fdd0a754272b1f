#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "volume/volume.h"

namespace clipgs {

/// How often places of a value are how steep: tissues are spots at the bottom, the borders between
/// two of them arches from one spot to the other (Kindlmann, Durkin 1998).
struct SteepnessHistogram {
  static constexpr int kColumns = 800;
  static constexpr int kRows = 400;
  using Counts = std::array<std::array<std::uint64_t, kColumns>, kRows>;

  float low = 0;       ///< value at the left end
  float high = 1;      ///< … and at the right one
  float steepest = 1;  ///< ‖∇v‖ at the upper end, value units per mm; the lower one is 0
  std::unique_ptr<Counts> counts = std::make_unique<Counts>();  ///< the first row is even matter
};

/// Of values from `low` to `high`, as far as the volume's reach, at a place in every voxel (of
/// larger volumes at some eight million of them). Values and ‖∇v‖ are those that pictures of the
/// voxels as scanned have: trilinear, by central differences over a voxel to either side. Upwards
/// it reaches to where one place in a thousand is steeper, which are left out. Throws Error for a
/// volume of one value, and where it has none, or no steep ones, between the two; `where` names the
/// volume in errors.
SteepnessHistogram steepness_histogram(const Volume& volume, float low, float high,
                                       const std::string& where);

}  // namespace clipgs
