#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/helper_process.h"
#include "volume/dicom_file.h"

namespace clipgs {

/// Decompresses encapsulated grey images (JPEG, JPEG-LS, JPEG 2000, RLE), by GDCM. That crashes on
/// corrupt pixels, and so works in a process of its own, which begins with the first image.
class PixelDecoder {
 public:
  /// The image in its pieces to little-endian integers of header.bits_allocated, rows x columns, as
  /// a string of bytes. Throws Error.
  std::string decode(const DicomHeader& header,
                     std::span<const std::span<const std::uint8_t>> fragments);

 private:
  std::optional<HelperProcess> gdcm_;
};

}  // namespace clipgs
