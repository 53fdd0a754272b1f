#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "volume/dicom_file.h"
#include "volume/gaps.h"
#include "volume/stored_image.h"
#include "volume/volume_size.h"

namespace clipgs {

/// The images of one series that lie parallel, sorted along their normal: what can become a volume.
/// (A series that also holds a localizer makes two of these, one of several phases one for each.)
struct DicomStack {
  std::string uid;
  std::string modality;  ///< "CT", "MR", ...
  int series_number = 0;
  std::string phase;  ///< what sets it apart from others at the same places (split_phases())
  std::vector<DicomHeader> slices;

  std::uint64_t voxels() const;
  /// "CT, series 3, acquisition 2, 120 slices of 512 x 512".
  std::string describe() const;
};

/// Groups images into stacks, the largest first, phases of the same size in their order; what is
/// derived from pictures (segmentations, doses) after all pictures. Images without a position are
/// left out.
std::vector<DicomStack> group_into_stacks(const std::vector<DicomHeader>& headers);

/// The size of what read_stack() makes of it, without reading pixels. Throws Error.
VolumeSize stack_size(const DicomStack& stack, Gaps gaps, const std::string& where);

/// Reads the stack's pixels onto a regular grid. Tilted and uneven stacks and those that lack a few
/// slices (plan_stack()) are resampled linearly, `fill` outside every slice, with a warning that
/// says what was done. `fill` is also what pixels become that their files call padding. `check`
/// sees the size before the pixels are read. Throws Error.
StoredImage read_stack(const DicomStack& stack, float fill, Gaps gaps, const std::string& where,
                       const SizeCheck& check = {});

}  // namespace clipgs
