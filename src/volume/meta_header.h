#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "volume/image_header.h"

namespace clipgs {

/// What the beginning of a MetaImage file (.mha, .mhd) says, by ITK's description of the format.
/// `bytes` is the whole header, or more of the file; source.offset becomes its length where the
/// voxels follow it. The world is LPS; lengths are in DistanceUnits, mm if that gives none. Throws
/// Error.
ImageHeader parse_meta_header(std::span<const std::uint8_t> bytes, const std::string& where);

}  // namespace clipgs
