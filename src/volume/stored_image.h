#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/geometry.h"
#include "volume/hints.h"
#include "volume/voxel_values.h"

namespace clipgs {

/// An image as a file stores it, before anything is made of it; LPS millimetres as in DICOM.
struct StoredImage {
  IVec3 dims{0};
  glm::dvec3 spacing{1};
  glm::dmat3 direction{1};        ///< columns: LPS directions of the index axes
  glm::dvec3 origin{0};           ///< LPS mm of the centre of voxel (0, 0, 0)
  bool eight_bit = false;         ///< stored as 8-bit integers
  VoxelValues values;             ///< scalar images: rescaled by the file's slope and intercept
  std::vector<std::uint8_t> rgb;  ///< colour images, 3 a voxel; values is then empty
  Hints hints;                    ///< what the header says of it
};

/// Larger volumes are refused before anything is allocated; see require_supported().
constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 32;

}  // namespace clipgs
