#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "core/error.h"
#include "core/image.h"

// Headers of stb are written in a style of their own.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#define STBI_ONLY_HDR
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace clipgs {

Image read_hdr(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (!file) {
    throw Error("{}: cannot be opened", path.string());
  }
  if (stbi_is_hdr_from_file(file.get()) == 0) {
    throw Error("{}: not a Radiance HDR picture", path.string());
  }
  int width = 0;
  int height = 0;
  int channels = 0;
  const std::unique_ptr<float, void (*)(void*)> pixels(
      stbi_loadf_from_file(file.get(), &width, &height, &channels, 3), &stbi_image_free);
  if (!pixels) {
    throw Error("{}: damaged HDR picture ({})", path.string(), stbi_failure_reason());
  }
  Image image(width, height, 3);
  std::copy_n(pixels.get(), image.data.size(), image.data.begin());
  for (const float value : image.data) {
    if (!std::isfinite(value) || value < 0) {
      throw Error("{}: damaged HDR picture (a value that is not a number)", path.string());
    }
  }
  return image;
}

}  // namespace clipgs
