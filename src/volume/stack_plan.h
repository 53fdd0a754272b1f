#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "volume/dicom_file.h"
#include "volume/gaps.h"

namespace clipgs {

glm::dvec3 normal_of(const DicomHeader& slice);

/// mm from the plane through the patient's origin.
double along_normal(const DicomHeader& slice, const glm::dvec3& normal);

/// Slices that are missing between two neighbours.
struct StackGap {
  size_t after = 0;  ///< index of the slice before it
  int missing = 0;
};

/// Where the slices of a stack lie along the normal, and what has to be done about it.
struct StackPlan {
  double step = 0;             ///< mm between slices of the regular grid
  double smallest_step = 0;    ///< mm, as found, gaps left out
  double largest_step = 0;     ///< mm, as found, gaps left out
  bool uneven = false;         ///< steps differ, gaps left out: resample along the normal
  std::vector<StackGap> gaps;  ///< a few slices to interpolate
  double tilt_deg = 0;         ///< between the line of the slices and their normal
  double largest_shift = 0;    ///< mm within the plane, of any slice against an untilted stack
  bool sheared = false;        ///< the shift exceeds half a pixel: resample within the planes

  bool resampled() const { return uneven || sheared || !gaps.empty(); }
};

/// At most so many slices in a row, and such a part of all slices, are interpolated.
constexpr int kMostMissingInARow = 3;
constexpr double kMostMissingPart = 0.1;

/// Decides from the positions alone, before any pixel is read. Steps are *even* if all lie within 2
/// % (or 0.02 mm) of their median. If they are not, slices are *missing* where one or two equal
/// steps in a row are 2, 3, ... times (to 5 %) as long as those before and after, or more than 3.5
/// times as long as most. Everything else (4 mm, then 7 mm; three or more doubled steps in a row)
/// is a change of spacing. Throws Error that says how many slices are missing and after which, if
/// they are more than a few (kMostMissingInARow, kMostMissingPart) or gaps are to be refused.
StackPlan plan_stack(const std::vector<DicomHeader>& slices, Gaps gaps, const std::string& where);

/// Which slices are missing, for people: "2 of 41 slices are missing: slices 7 to 8 (at 12.00 to
/// 14.00 mm)"; slices count from 1 with the missing ones, positions are along the normal.
std::string describe_gaps(const StackPlan& plan, const std::vector<DicomHeader>& slices);

}  // namespace clipgs
