#include "volume/image_header.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "volume/stored_image.h"

namespace clipgs {
namespace {

constexpr double kMostStackedFrames = 1 << 20;
constexpr double kMostAlong = 1 << 30;  // voxels along an axis: indices are ints

void require_step(double length, const std::string& field, const std::string& where) {
  constexpr double kShortest = 1e-6;  // mm
  constexpr double kLongest = 1e6;
  if (!(length > kShortest && length < kLongest)) {
    throw Error("{}: its {} puts voxels {:.6g} mm apart; the header is corrupt", where, field,
                length);
  }
}

/// The cosine of the angle between two axes that are nearly perpendicular.
double most_skew(const glm::dmat3& steps) {
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    most = std::max(most, std::abs(glm::dot(glm::normalize(steps[i]), glm::normalize(steps[j]))));
  }
  return most;
}

void warn_of_odd_size(ImageHeader& header, const GeometryFields& fields, const std::string& where) {
  constexpr double kSmallest = 20;  // mm
  constexpr double kLargest = 3000;
  const glm::dvec3 size = header.spacing * glm::dvec3(header.dims);
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    longest = size[axis] > size[longest] ? axis : longest;
  }
  if (size[longest] < kSmallest || size[longest] > kLargest) {
    header.warnings.push_back(fmt::format(
        "{}: {:.4g} x {:.4g} x {:.4g} mm large by its {}: {} for a body; check its unit", where,
        size.x, size.y, size.z, fields.spacing[longest],
        size[longest] < kSmallest ? "small" : "too large"));
  }
}

}  // namespace

double finite(double value, const std::string& field, const std::string& where) {
  if (!std::isfinite(value)) {
    throw Error("{}: its {} is {}; the header is corrupt", where, field, value);
  }
  return value;
}

double spacing_or_one(double spacing, const std::string& field, ImageHeader& header,
                      const std::string& where) {
  if (spacing != 0) {
    return spacing;
  }
  header.warnings.push_back(
      fmt::format("{}: its {} is 0: voxels of 1 are assumed along that axis", where, field));
  return 1;
}

void set_sizes(ImageHeader& header, std::span<const double> sizes, const std::string& field,
               const std::string& where) {
  double voxels = 1;
  for (size_t axis = 0; axis < sizes.size(); ++axis) {
    const double size = sizes[axis];
    if (!(size >= 1 && size == std::trunc(size))) {  // NaN too
      throw Error("{}: its {} gives the size {} along axis {}; the header is corrupt", where, field,
                  size, axis + 1);
    }
    const double most = axis < 3 ? std::min(static_cast<double>(kMaxVoxels) / voxels, kMostAlong)
                                 : kMostStackedFrames;
    if (size > most) {
      throw Error("{}: its {} gives more than 2^32 voxels, or 2^20 frames; crop or downsample it",
                  where, field);
    }
    if (axis < 3) {
      voxels *= size;
      header.dims[static_cast<int>(axis)] = static_cast<int>(size);
    } else if (size > 1 && header.frames > 1) {
      throw Error("{}: its {} gives more than four axes; store the volume to show as a 3D file",
                  where, field);
    } else {
      header.frames *= static_cast<int>(size);
    }
  }
}

void set_channels(ImageHeader& header, double per_voxel, const std::string& where) {
  const bool colour = (per_voxel == 3 || per_voxel == 4) && header.type == ScalarType::kUint8;
  if (per_voxel != 1 && !colour) {
    throw Error("{}: {} numbers a voxel; one number, or 8-bit RGB, is needed", where, per_voxel);
  }
  header.channels = static_cast<int>(per_voxel);
}

bool perpendicular(const glm::dmat3& steps) {
  constexpr double kLargestSkew = 1e-3;
  return most_skew(steps) < kLargestSkew;
}

void set_geometry(ImageHeader& header, const glm::dmat3& steps, const glm::dvec3& origin,
                  const GeometryFields& fields, const std::string& where) {
  constexpr double kFarthest = 1e6;  // mm
  constexpr double kFlat = 1e-4;
  for (int axis = 0; axis < 3; ++axis) {
    finite(origin[axis], fields.origin, where);
    const double length = glm::length(steps[axis]);
    require_step(finite(length, fields.spacing[axis], where), fields.spacing[axis], where);
    header.spacing[axis] = length;
    header.direction[axis] = steps[axis] / length;
    if (std::abs(origin[axis]) > kFarthest) {
      throw Error("{}: its {} puts it {:.6g} mm away; the header is corrupt", where, fields.origin,
                  origin[axis]);
    }
  }
  if (std::abs(glm::determinant(header.direction)) < kFlat) {
    throw Error("{}: the axes of its {} lie in one plane: no volume; the header is corrupt", where,
                fields.directions);
  }
  if (!perpendicular(steps)) {
    throw Error(
        "{}: the axes of its {} are not perpendicular (sheared by {:.3g} degrees); resample it to "
        "a "
        "regular grid",
        where, fields.directions, glm::degrees(std::asin(std::min(1.0, most_skew(steps)))));
  }
  header.origin = origin;
  warn_of_odd_size(header, fields, where);
}

}  // namespace clipgs
