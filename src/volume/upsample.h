#pragma once

#include <cstdint>

#include "core/geometry.h"
#include "volume/transfer_function.h"
#include "volume/volume.h"
#include "volume/volume_size.h"

namespace clipgs {

/// No volume is upsampled to more voxels.
constexpr std::uint64_t kMostUpsampled = std::uint64_t{160} << 20;

/// How many voxels along each axis take the place of one, so that surfaces have no terraces: thick
/// slices become as fine as the other axes, cubes two or three times finer where a picture of the
/// whole can show it, as far as kMostUpsampled reaches. 1 for photographs.
IVec3 upsampling_factors(const VolumeSize& size);

/// The size with as many voxels as upsample() may make of such a volume.
VolumeSize most_upsampled(VolumeSize size);

/// Whether upsample() does anything: not to photographs, nor to kMostUpsampled voxels and more.
inline bool can_be_upsampled(const VolumeSize& size) {
  return !size.rgb && size.voxels() < kMostUpsampled;
}
bool can_be_upsampled(const Volume& volume);

/// Bytes of memory that upsample() takes beside the scanned volume at most, its result included.
std::uint64_t upsampling_memory(const VolumeSize& size);

/// A volume of finer voxels for pictures: the centres of the scanned ones are kept, and factor − 1
/// lie between two of them. Within matter, values are interpolated linearly. Where what `transfer`
/// shows meets what it does not, and values change by more than noise, surfaces are smoothed:
/// values flow along their level sets by mean curvature (Osher and Sethian 1988, as Whitaker 2000
/// smooths binary volumes), and the mean over every scanned voxel, which is what the scanner
/// measured, is given back now and then. No value leaves the range of the scanned ones around it.
/// Volume::scanned, which is read and not drawn, is left out.
/// The bytes are the same at any thread count. Throws Error where a factor is below 1.
Volume upsample(Volume volume, const IVec3& factors, const TransferFunction& transfer);

/// The same by upsampling_factors() of the part that is shown: planes around it that show nothing
/// are left out. What can_be_upsampled() is false of comes back as it is.
Volume upsample(Volume volume, const TransferFunction& transfer);

}  // namespace clipgs
