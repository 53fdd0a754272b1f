#include "volume/volume_size.h"

#include <algorithm>

#include "core/error.h"
#include "core/memory.h"
#include "volume/stored_image.h"

namespace clipgs {
namespace {

// Bytes of one voxel; see the header.
std::uint64_t value_bytes(const VolumeSize& size) {
  constexpr int kLuminance = 4;
  constexpr int kColour = 3;
  return size.rgb ? kColour + kLuminance : size.stored_bytes <= 2 ? 2 : 4;
}

}  // namespace

std::uint64_t VolumeSize::padded_voxels() const {
  const IVec3 padded = dims + kBorder;
  return static_cast<std::uint64_t>(padded.x) * padded.y * padded.z;
}

std::uint64_t VolumeSize::loaded() const {
  return voxels() * (value_bytes(*this) + (labels ? 1 : 0) + (scanned ? value_bytes(*this) : 0));
}

std::uint64_t VolumeSize::loading() const {
  const std::uint64_t alone = value_bytes(*this);
  // Before and after axes are flipped; the luminance of colours is found later.
  // While values are made of those that are kept, there are both, and those that they become.
  const std::uint64_t reordering = rgb ? alone : scanned ? 3 * alone : 2 * alone;
  constexpr std::uint64_t kLabels = 4;  // their codes, before and after as well
  return voxels() *
         (labels ? std::max(reordering, (scanned ? 2 : 1) * alone + kLabels) : reordering);
}

void require_supported(const VolumeSize& size, const std::string& where) {
  if (size.padded_voxels() > kMaxVoxels) {
    throw Error(
        "{}: {} x {} x {} voxels; at most 2^32, with a border, are supported; crop or downsample "
        "it",
        where, size.dims.x, size.dims.y, size.dims.z);
  }
}

std::string lack_of_memory(const VolumeSize& size, std::uint64_t work, std::uint64_t available) {
  const std::uint64_t needed = std::max(size.loading(), size.loaded() + work);
  if (needed <= available) {
    return {};
  }
  return fmt::format(
      "{} x {} x {} voxels need {} of memory, {} are free; close other programs, crop or "
      "downsample the volume (with half the voxels along each axis {} are enough), trace it "
      "--as-scanned, or take a machine with more",
      size.dims.x, size.dims.y, size.dims.z, gigabytes(needed), gigabytes(available),
      gigabytes(needed / 8));
}

}  // namespace clipgs
