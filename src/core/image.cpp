#include "core/image.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <spng.h>

#include "core/background.h"
#include "core/error.h"
#include "core/file.h"

namespace clipgs {

Image premultiplied(const Image& image) {
  Image out(image.width, image.height, 4);
  for (size_t i = 0; i < image.pixels(); ++i) {
    const float* in = &image.data[i * image.channels];
    const float alpha = image.channels == 4 ? in[3] : 1.0f;
    for (int c = 0; c < 3; ++c) {
      out.data[i * 4 + c] = alpha * in[c];
    }
    out.data[i * 4 + 3] = alpha;
  }
  return out;
}

Image composite(const Image& rgba, float r, float g, float b) {
  return composite(rgba, Background{Vec3(r, g, b), Vec3(r, g, b)});
}

namespace {

using SpngContext = std::unique_ptr<spng_ctx, void (*)(spng_ctx*)>;

void check(int code, const std::filesystem::path& path) {
  if (code != 0) {
    throw Error("{}: not a readable PNG ({}); write it again", path.string(), spng_strerror(code));
  }
}

}  // namespace

Image read_png(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> bytes = read_file(path);
  const SpngContext ctx(spng_ctx_new(0), spng_ctx_free);
  check(spng_set_image_limits(ctx.get(), 16384, 16384), path);
  check(spng_set_png_buffer(ctx.get(), bytes.data(), bytes.size()), path);
  spng_ihdr header{};
  check(spng_get_ihdr(ctx.get(), &header), path);
  spng_trns transparency{};
  const bool alpha = header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
                     header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA ||
                     spng_get_trns(ctx.get(), &transparency) == 0;
  // Decode to 16 bits always: one path for every depth, and 8-bit values v become 257·v exactly.
  size_t size = 0;
  check(spng_decoded_image_size(ctx.get(), SPNG_FMT_RGBA16, &size), path);
  std::vector<std::uint16_t> decoded(size / sizeof(std::uint16_t));
  check(spng_decode_image(ctx.get(), decoded.data(), size, SPNG_FMT_RGBA16, SPNG_DECODE_TRNS),
        path);
  Image image(static_cast<int>(header.width), static_cast<int>(header.height), alpha ? 4 : 3);
  for (size_t i = 0; i < image.pixels(); ++i) {
    for (int c = 0; c < image.channels; ++c) {
      image.data[i * image.channels + c] = static_cast<float>(decoded[i * 4 + c]) / 65535.0f;
    }
  }
  return image;
}

void write_png(const std::filesystem::path& path, const Image& image, int bits) {
  const SpngContext ctx(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free);
  check(spng_set_option(ctx.get(), SPNG_ENCODE_TO_BUFFER, 1), path);
  check(spng_set_option(ctx.get(), SPNG_IMG_COMPRESSION_LEVEL, 4), path);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.width);
  header.height = static_cast<std::uint32_t>(image.height);
  header.bit_depth = static_cast<std::uint8_t>(bits);
  header.color_type = image.channels == 4   ? SPNG_COLOR_TYPE_TRUECOLOR_ALPHA
                      : image.channels == 3 ? SPNG_COLOR_TYPE_TRUECOLOR
                                            : SPNG_COLOR_TYPE_GRAYSCALE;
  check(spng_set_ihdr(ctx.get(), &header), path);
  const float scale = bits == 16 ? 65535.0f : 255.0f;
  std::vector<std::uint8_t> raw(image.data.size() * (bits / 8));
  for (size_t i = 0; i < image.data.size(); ++i) {
    const auto q =
        static_cast<std::uint16_t>(std::lround(std::clamp(image.data[i], 0.0f, 1.0f) * scale));
    if (bits == 16) {
      // SPNG_FMT_PNG takes host byte order and swaps it.
      reinterpret_cast<std::uint16_t*>(raw.data())[i] = q;
    } else {
      raw[i] = static_cast<std::uint8_t>(q);
    }
  }
  check(spng_encode_image(ctx.get(), raw.data(), raw.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE),
        path);
  size_t length = 0;
  int error = 0;
  const std::unique_ptr<void, void (*)(void*)> png(spng_get_png_buffer(ctx.get(), &length, &error),
                                                   std::free);
  check(error, path);
  write_file(path, png.get(), length);
}

}  // namespace clipgs
