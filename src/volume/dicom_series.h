#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "volume/dicom_file.h"
#include "volume/itk_reader.h"

namespace clipgs {

/// The images of one series that lie parallel, sorted along their normal: what can become a volume.
/// (A series that also holds a localizer makes two of these.)
struct DicomStack {
  std::string uid;
  std::string modality;  ///< "CT", "MR", ...
  int series_number = 0;
  std::vector<DicomHeader> slices;

  std::uint64_t voxels() const;
  /// "CT, series 3, 120 slices of 512 x 512".
  std::string describe() const;
};

/// Groups images into stacks, the largest first. Images without a position are left out.
std::vector<DicomStack> group_into_stacks(const std::vector<DicomHeader>& headers);

/// Where the slices of a stack lie along the normal, and what has to be done about it.
struct StackPlan {
  double step = 0;           ///< mm between slices of the regular grid
  double smallest_step = 0;  ///< mm, as found
  double largest_step = 0;   ///< mm, as found
  bool uneven = false;       ///< steps differ: resample along the normal
  double tilt_deg = 0;       ///< between the line of the slices and their normal
  double largest_shift = 0;  ///< mm within the plane, of any slice against an untilted stack
  bool sheared = false;      ///< the shift exceeds half a pixel: resample within the planes
};

/// Decides from the positions alone, before any pixel is read. Steps are *even* if all lie within 2
/// % (or 0.02 mm) of their median. If they are not, slices are *missing* where one or two equal
/// steps in a row are 2, 3, ... times (to 5 %) as long as those before and after, or more than 3.5
/// times as long as most. Everything else (4 mm, then 7 mm; three or more doubled steps in a row)
/// is a change of spacing. Throws Error that says how many slices are missing and after which.
StackPlan plan_stack(const std::vector<DicomHeader>& slices, const std::string& where);

/// Reads the stack's pixels onto a regular grid. Tilted and uneven stacks are resampled linearly,
/// `fill` outside every slice, with a warning that says what was done. Throws Error.
StoredImage read_stack(const DicomStack& stack, float fill, const std::string& where);

}  // namespace clipgs
