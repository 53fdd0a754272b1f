#pragma once

#include <string>
#include <vector>

#include "volume/dicom_file.h"

namespace clipgs {

/// Images of one phase: one at each place, but for copies of the same image.
struct DicomPhase {
  std::string name;  ///< what sets it apart, "acquisition 2, echo time 4.76 ms"; empty: nothing
  std::vector<DicomHeader> slices;
};

/// Tells apart the images of a stack that lie at the same places along its normal: stations beside
/// one another (of a spine, of two breasts), cardiac phases, contrast phases, dynamics, echoes.
/// `slices` are parallel and sorted along their normal; so are those of each phase. The phases come
/// in the order of what sets them apart, which is sought in this order, and within each phase
/// again: position within the planes, temporal position, trigger time, echo time, b-value,
/// acquisition number, image type, time of acquisition. Each has to make
///  - phases by its values, which all cover the same places; or else
///  - phases by the order of its values at each place, if all have equally many (trigger times of
///    a cine differ from slice to slice, and some scanners number acquisitions slice by slice); or
///  - phases by its values, at most half as many again as lie at one place, that cover different
///    places, but one of them shares half of its own with others (contrast phases of other extent;
///    blocks of one scan that overlap by a few slices are no phases).
/// What none sets apart stays together.
std::vector<DicomPhase> split_phases(std::vector<DicomHeader> slices);

/// Whether two images lie at the same place along the normal.
bool same_place(const DicomHeader& a, const DicomHeader& b, const glm::dvec3& normal);

}  // namespace clipgs
