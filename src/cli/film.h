#pragma once

#include <filesystem>
#include <memory>

#include "core/image.h"

namespace clipgs {

/// Pictures one after the other, as a file that moves or a folder of them.
class Film {
 public:
  virtual ~Film() = default;
  /// Adds a picture of 3 or 4 channels, which stays for so many pictures' time. All are of one
  /// size. Throws Error.
  virtual void add(const Image& picture, int times) = 0;
  /// Writes what is to be written. Throws Error.
  virtual void finish() = 0;
};

/// By the name's ending: animated WebP, MP4 (H.264) and WebM (VP9), both by the program ffmpeg, or,
/// without an ending, a folder of PNGs. Throws Error for other endings, where the file cannot be
/// written, and where ffmpeg is not there.
std::unique_ptr<Film> make_film(const std::filesystem::path& output, float frames_per_second);

}  // namespace clipgs
