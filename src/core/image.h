#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace clipgs {

/// A picture of float samples, row-major from the top left, channels interleaved.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> data;  ///< [height, width, channels]

  Image() = default;
  Image(int w, int h, int c)
      : width(w), height(h), channels(c), data(static_cast<size_t>(w) * h * c, 0.0f) {}

  size_t pixels() const { return static_cast<size_t>(width) * height; }
  float* at(int x, int y) { return &data[(static_cast<size_t>(y) * width + x) * channels]; }
  const float* at(int x, int y) const {
    return &data[(static_cast<size_t>(y) * width + x) * channels];
  }
};

/// sRGB transfer curve (IEC 61966-2-1); input is clamped to [0, 1].
float srgb_from_linear(float linear);
float linear_from_srgb(float srgb);

/// Colours times alpha, of straight alpha: those of transparent pixels mean nothing, premultiplied
/// they can be averaged. Of 3 channels: opaque. [height, width, 4].
Image premultiplied(const Image& image);

/// Straight-alpha RGBA over a constant background, as RGB. A picture of 3 channels is copied.
Image composite(const Image& rgba, float r, float g, float b);

/// Reads an 8- or 16-bit PNG as 3 (no alpha) or 4 channels in [0, 1]. Throws Error.
Image read_png(const std::filesystem::path& path);

/// Reads a Radiance HDR picture: 3 channels, linear. Throws Error.
Image read_hdr(const std::filesystem::path& path);

/// Reads a portable float map (PFM) of one or three channels: 3 channels, linear, whatever floats
/// it holds, NaN among them. Of the scale in its header only the sign counts. Throws Error.
Image read_pfm(const std::filesystem::path& path);

/// Writes 1, 3 or 4 channels in [0, 1] (clamped, rounded) as PNG with 8 or 16 bits a channel,
/// atomically (see write_file). Throws Error.
void write_png(const std::filesystem::path& path, const Image& image, int bits = 8);

}  // namespace clipgs
