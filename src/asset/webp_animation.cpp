#include "asset/webp_animation.h"

#include <cmath>
#include <webp/encode.h>
#include <webp/mux.h>

#include "asset/webp.h"
#include "core/error.h"

namespace clipgs {

struct WebpAnimation::Encoder {
  Encoder(int w, int h) : width(w), height(h) {
    WebPAnimEncoderOptions options;
    WebPAnimEncoderOptionsInit(&options);
    options.minimize_size = 1;
    encoder = WebPAnimEncoderNew(width, height, &options);
    if (encoder == nullptr) {
      throw Error("a WebP animation cannot be {} × {} pixels", width, height);
    }
  }
  ~Encoder() { WebPAnimEncoderDelete(encoder); }
  Encoder(const Encoder&) = delete;
  Encoder& operator=(const Encoder&) = delete;

  void require(int ok) const {
    if (ok == 0) {
      throw Error("the animation cannot be encoded: {}", WebPAnimEncoderGetError(encoder));
    }
  }

  int width;
  int height;
  WebPAnimEncoder* encoder;
};

WebpAnimation::WebpAnimation(float frames_per_second, float quality)
    : milliseconds_(1000.0 / frames_per_second), quality_(quality) {}

WebpAnimation::~WebpAnimation() = default;

void WebpAnimation::add(const Image& picture, int times) {
  if (!encoder_) {
    encoder_ = std::make_unique<Encoder>(picture.width, picture.height);
  }
  if (picture.width != encoder_->width || picture.height != encoder_->height) {
    throw Error("an animation of {} × {} pixels cannot show a picture of {} × {}", encoder_->width,
                encoder_->height, picture.width, picture.height);
  }
  const Texels texels = to_texels(picture);
  WebPConfig config;
  WebPConfigInit(&config);
  config.quality = quality_;
  WebPPicture frame;
  WebPPictureInit(&frame);
  frame.width = picture.width;
  frame.height = picture.height;
  frame.use_argb = 1;
  const int at = static_cast<int>(std::lround(added_ * milliseconds_));
  const bool added = WebPPictureImportRGBA(&frame, texels.rgba.data(), 4 * frame.width) != 0 &&
                     WebPAnimEncoderAdd(encoder_->encoder, &frame, at, &config) != 0;
  WebPPictureFree(&frame);
  encoder_->require(added ? 1 : 0);
  added_ += times;
}

Bytes WebpAnimation::finish() {
  if (!encoder_) {
    throw Error("an animation needs a picture");
  }
  const int end = static_cast<int>(std::lround(added_ * milliseconds_));
  encoder_->require(WebPAnimEncoderAdd(encoder_->encoder, nullptr, end, nullptr));
  WebPData data;
  WebPDataInit(&data);
  encoder_->require(WebPAnimEncoderAssemble(encoder_->encoder, &data));
  Bytes bytes(data.bytes, data.bytes + data.size);
  WebPDataClear(&data);
  return bytes;
}

}  // namespace clipgs
