#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "volume/hints.h"
#include "volume/scalar_type.h"

namespace clipgs {

/// Where the voxels of an image lie, and how they are packed.
struct VoxelSource {
  enum class Encoding { kRaw, kDeflate, kText };

  /// Names relative to the header's folder, in order, each with the same share of the voxels;
  /// empty: the voxels follow the header in its own file.
  std::vector<std::string> files;
  Encoding encoding = Encoding::kRaw;  ///< kDeflate: gzip or zlib
  std::uint64_t offset = 0;            ///< bytes of the file before the voxels, packed or not
  std::uint64_t lines = 0;             ///< lines of text to leave out after them
  std::uint64_t unpacked_offset = 0;   ///< bytes to leave out after unpacking
  bool at_end = false;                 ///< raw: the voxels are the last bytes of the file
};

/// What the header of a NIfTI, NRRD or MetaImage file says. Every number was checked: sizes can be
/// multiplied and allocated, the geometry is finite, bounded, and perpendicular.
struct ImageHeader {
  IVec3 dims{0};     ///< at most kMaxVoxels in all
  int frames = 1;    ///< volumes, one after the other
  int channels = 1;  ///< numbers a voxel: 1, or 3 (RGB) or 4 (RGBA) of ScalarType::kUint8
  ScalarType type = ScalarType::kUint8;
  bool big_endian = false;
  double slope = 1;  ///< value = slope·stored + intercept
  double intercept = 0;
  glm::dvec3 spacing{1};    ///< mm
  glm::dmat3 direction{1};  ///< columns: unit LPS directions of the index axes; may mirror
  glm::dvec3 origin{0};     ///< LPS mm of the centre of voxel (0, 0, 0)
  VoxelSource source;
  Hints hints;
  std::vector<std::string> warnings;  ///< what had to be assumed, one line each

  std::uint64_t frame_bytes() const {
    return static_cast<std::uint64_t>(dims.x) * dims.y * dims.z * channels * size_of(type);
  }
};

/// Names of the header's fields, for messages.
struct GeometryFields {
  std::array<std::string, 3> spacing;  ///< how far apart voxels are along each axis
  std::string directions;
  std::string origin;
};

/// `spacing`, or 1 with a warning that names the field if it is 0.
double spacing_or_one(double spacing, const std::string& field, ImageHeader& header,
                      const std::string& where);

/// Sets sizes. Throws Error for a size below 1, more than kMaxVoxels or 2^20 frames. `sizes` has 3
/// or more; above the third only `frames` may be more than 1.
void set_sizes(ImageHeader& header, std::span<const double> sizes, const std::string& field,
               const std::string& where);

/// Sets spacing, direction and origin from the steps between voxels along the three index axes and
/// the centre of the first voxel, LPS mm. Throws Error, naming the field, for numbers that are not
/// finite or out of bounds (steps of 1e-6 to 1e6 mm, 1e6 mm from the origin), and for axes that
/// cannot be inverted or shear. Warns of a volume below 2 cm or above 3 m.
void set_geometry(ImageHeader& header, const glm::dmat3& steps, const glm::dvec3& origin,
                  const GeometryFields& fields, const std::string& where);

/// Whether the steps between voxels are perpendicular to 1e-3 radians (a sheared grid is not).
bool perpendicular(const glm::dmat3& steps);

/// Sets channels and frames for `per_voxel` numbers a voxel. Throws Error unless it is one number
/// or 8-bit RGB(A).
void set_channels(ImageHeader& header, double per_voxel, const std::string& where);

/// `value`, or an Error that names the field if it is NaN or infinite.
double finite(double value, const std::string& field, const std::string& where);

}  // namespace clipgs
