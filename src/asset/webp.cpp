#include "asset/webp.h"

#include <algorithm>
#include <cmath>
#include <webp/decode.h>
#include <webp/encode.h>

#include "core/error.h"

namespace clipgs {

namespace {

/// Owns what libwebp allocates for one encoding.
class Picture {
 public:
  Picture(int width, int height) {
    if (width < 1 || height < 1 || width > WEBP_MAX_DIMENSION || height > WEBP_MAX_DIMENSION) {
      throw Error("a WebP cannot be {} × {} texels, at most {} a side", width, height,
                  WEBP_MAX_DIMENSION);
    }
    WebPPictureInit(&picture_);
    WebPMemoryWriterInit(&writer_);
    picture_.width = width;
    picture_.height = height;
    picture_.writer = WebPMemoryWrite;
    picture_.custom_ptr = &writer_;
  }
  ~Picture() {
    WebPPictureFree(&picture_);
    WebPMemoryWriterClear(&writer_);
  }
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  Bytes encode(const WebPConfig& config, const std::uint8_t* rgba) {
    picture_.use_argb = config.lossless;
    if (WebPPictureImportRGBA(&picture_, rgba, 4 * picture_.width) == 0 ||
        WebPEncode(&config, &picture_) == 0) {
      throw Error("a {} × {} WebP cannot be encoded (libwebp error {})", picture_.width,
                  picture_.height, static_cast<int>(picture_.error_code));
    }
    return {writer_.mem, writer_.mem + writer_.size};
  }

 private:
  WebPPicture picture_{};
  WebPMemoryWriter writer_{};
};

/// Whether there is no colour to take care of.
bool is_grey(const Texels& texels) {
  for (size_t i = 0; i < texels.rgba.size(); i += 4) {
    if (texels.rgba[i] != texels.rgba[i + 1] || texels.rgba[i] != texels.rgba[i + 2]) {
      return false;
    }
  }
  return true;
}

}  // namespace

Texels::Texels(int w, int h) : width(w), height(h), rgba(4 * size(), 0) {
  for (size_t i = 3; i < rgba.size(); i += 4) {
    rgba[i] = 255;
  }
}

Bytes encode_webp(const Texels& texels, Saving saving) {
  // 9 is a hundred times slower and not smaller on such data.
  const int level = saving == Saving::kBytes ? 6 : 0;
  WebPConfig config;
  WebPConfigInit(&config);
  WebPConfigLosslessPreset(&config, level);
  config.exact = 1;
  return Picture(texels.width, texels.height).encode(config, texels.rgba.data());
}

Bytes encode_webp_data(const Texels& texels, float quality, Saving saving) {
  WebPConfig config;
  WebPConfigInit(&config);
  config.quality = quality;
  // 6 takes twice as long as 4 and is a hundredth smaller.
  config.method = saving == Saving::kBytes ? 4 : 1;
  config.thread_level = 1;
  config.sns_strength = 0;
  config.filter_strength = 0;
  config.use_sharp_yuv = saving == Saving::kBytes && !is_grey(texels) ? 1 : 0;
  return Picture(texels.width, texels.height).encode(config, texels.rgba.data());
}

Texels to_texels(const Image& image) {
  if (image.channels != 3 && image.channels != 4) {
    throw Error("a picture has 3 or 4 channels, not {}", image.channels);
  }
  Texels texels(image.width, image.height);
  for (size_t i = 0; i < image.pixels(); ++i) {
    for (int c = 0; c < image.channels; ++c) {
      const float value = image.data[i * image.channels + c];
      texels.rgba[4 * i + c] =
          static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
    }
  }
  return texels;
}

Bytes encode_webp(const Image& image, float quality) {
  const Texels texels = to_texels(image);
  WebPConfig config;
  WebPConfigInit(&config);
  config.quality = quality;
  config.method = 6;
  return Picture(image.width, image.height).encode(config, texels.rgba.data());
}

Texels decode_webp(std::span<const std::uint8_t> bytes, int width, int height,
                   const std::string& name) {
  int stated_width = 0;
  int stated_height = 0;
  if (WebPGetInfo(bytes.data(), bytes.size(), &stated_width, &stated_height) == 0) {
    throw Error("{}: is not a WebP image; the file is corrupt", name);
  }
  if (stated_width != width || stated_height != height) {
    throw Error("{}: is {} × {} texels, {} × {} were expected; the file is corrupt", name,
                stated_width, stated_height, width, height);
  }
  Texels texels(width, height);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), texels.rgba.data(), texels.rgba.size(),
                         4 * width) == nullptr) {
    throw Error("{}: cannot be decoded; the file is truncated or corrupt", name);
  }
  return texels;
}

}  // namespace clipgs
