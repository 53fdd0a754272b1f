#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "volume/image_header.h"

namespace clipgs {

/// What the beginning of an NRRD file says (NRRD0001 to NRRD0005), by the format's definition at
/// teem.sourceforge.net/nrrd/format.html. `bytes` is the whole header, or more of the file;
/// source.offset becomes its length where the voxels follow it.
///
/// Space: RAS, LAS or LPS by name (or LPS, with a warning, where the header names none); lengths in
/// "space units" or "units", mm if there are none. A fourth axis that changes slowest counts
/// frames, one that changes fastest counts colours. Encodings: raw, gzip and text. Throws Error.
ImageHeader parse_nrrd_header(std::span<const std::uint8_t> bytes, const std::string& where);

}  // namespace clipgs
