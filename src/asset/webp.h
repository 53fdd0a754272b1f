#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "asset/zip.h"
#include "core/image.h"

namespace clipgs {

/// 8-bit RGBA texels that carry data, row-major from the top left.
struct Texels {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  ///< [height, width, 4]

  Texels() = default;
  /// All (0, 0, 0, 255).
  Texels(int w, int h);
  size_t size() const { return static_cast<size_t>(width) * height; }
};

/// A picture of 3 or 4 channels in [0, 1], rounded to 8 bits. Throws Error.
Texels to_texels(const Image& image);

/// What an encoder is to save: kTime takes a fifth of the time, and 1.6 times the bytes.
enum class Saving { kBytes, kTime };

/// Lossless, texel for texel (RGB under alpha 0 as well). Throws Error.
Bytes encode_webp(const Texels& texels, Saving saving = Saving::kBytes);

/// Data that may change a little: evenly good everywhere, with nothing done for the eye's sake.
/// `quality` 0 to 100. Alpha must be 255. Throws Error.
Bytes encode_webp_data(const Texels& texels, float quality, Saving saving = Saving::kBytes);

/// A picture to look at: 3 or 4 channels in [0, 1], lossy, `quality` 0 to 100. Throws Error.
Bytes encode_webp(const Image& image, float quality);

/// Decodes a WebP of exactly that size; the size is checked before anything is allocated. `name`
/// is what errors call it. Throws Error.
Texels decode_webp(std::span<const std::uint8_t> bytes, int width, int height,
                   const std::string& name);

}  // namespace clipgs
