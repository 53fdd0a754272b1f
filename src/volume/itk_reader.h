#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "volume/dicom_file.h"
#include "volume/stored_image.h"

namespace clipgs {

/// A DICOM file of many frames as a volume, slope and intercept applied. Throws Error.
StoredImage read_multi_frame(const std::filesystem::path& path);

/// Decompresses the encapsulated pixels (JPEG, JPEG-LS, JPEG 2000, RLE) of a single-frame grey
/// image to little-endian integers of header.bits_allocated, rows x columns. Throws Error.
std::vector<std::uint8_t> decode_dicom_pixels(const DicomHeader& header,
                                              std::span<const std::uint8_t> fragments);

}  // namespace clipgs
