#pragma once

#include <filesystem>

#include "volume/image_header.h"
#include "volume/stored_image.h"

namespace clipgs {

/// Reads the voxels of one frame (from 0) that `header` of the file at `path` describes. Throws
/// Error if a single byte of any frame is missing, in that file or in those that it names, and if
/// packed data are damaged or do not match their checksum. Memory grows with what is in the files,
/// not with what the header promises.
StoredImage read_voxels(const ImageHeader& header, const std::filesystem::path& path, int frame);

}  // namespace clipgs
