#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "core/geometry.h"

namespace clipgs {

/// What is known of a volume before its voxels are read, and what memory they will take, bytes.
struct VolumeSize {
  IVec3 dims{0};
  int stored_bytes = 2;  ///< of a stored value
  bool rgb = false;      ///< a photograph
  bool labels = false;   ///< a segmentation is loaded with it
  bool scanned = false;  ///< its values are kept as they were before noise was taken out
  Vec3 spacing{1};       ///< mm between voxel centres

  std::uint64_t voxels() const { return static_cast<std::uint64_t>(dims.x) * dims.y * dims.z; }
  /// With the border of so many voxels along each axis that tracing needs around it.
  static constexpr int kBorder = 3;
  std::uint64_t padded_voxels() const;
  /// Of the loaded volume. Values that are stored in more than 16 bits may turn out to be few, and
  /// then take half of what this says.
  std::uint64_t loaded() const;
  /// The most while it is loaded: voxels are put in another order, and what is no body taken off.
  std::uint64_t loading() const;
};

/// Called with what a header says, before any voxel is read; throws if that is too much.
using SizeCheck = std::function<void(const VolumeSize&)>;

/// Throws Error for a volume of more than 2^32 voxels, its border included: tracing addresses no
/// more.
void require_supported(const VolumeSize& size, const std::string& where);

/// Empty if `available` bytes are enough to load the volume and then to work on it with `work`
/// bytes beside it; otherwise one line that says how many are needed and what to do.
std::string lack_of_memory(const VolumeSize& size, std::uint64_t work, std::uint64_t available);

}  // namespace clipgs
