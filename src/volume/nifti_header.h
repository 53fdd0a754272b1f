#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "volume/image_header.h"

namespace clipgs {

/// Bytes of a NIfTI file that parse_nifti_header() needs to see at most.
constexpr size_t kNiftiHeaderBytes = 540;

/// What the beginning of a NIfTI-1 or NIfTI-2 file says, by nifti1.h and nifti2.h of the NIfTI
/// Data Format Working Group, in either byte order.
///
/// Orientation: the sform (srow_x, srow_y, srow_z) if sform_code > 0, whatever the qform and pixdim
/// say; else the qform (quatern_*, qoffset_*, pixdim) if qform_code > 0; else voxels of pixdim,
/// with axes to the right, front and top, as the standard's method 1 has it. A sheared sform yields
/// to a qform where there is one. Where both forms are there and disagree by more than half a
/// voxel, a warning says so. Lengths are in the unit of xyzt_units, mm if that gives none.
///
/// `detached`: the voxels lie in the .img file beside (magic "ni1"). Throws Error.
struct NiftiHeader {
  ImageHeader image;
  bool detached = false;
};
NiftiHeader parse_nifti_header(std::span<const std::uint8_t> bytes, const std::string& where);

}  // namespace clipgs
