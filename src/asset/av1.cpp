#include "asset/av1.h"

#include <algorithm>
#include <aom/aom_encoder.h>
#include <aom/aomcx.h>
#include <cerrno>
#include <cstring>
#include <dav1d/dav1d.h>
#include <memory>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {

namespace {

// Slower ones are a twentieth smaller and take three times as long.
constexpr int kSpeed = 6;
constexpr std::uint8_t kGrey = 128;  // of both chroma planes
// Always as many: by one alone libaom chooses otherwise, and the bytes would be other ones.
constexpr int kEncoderThreads = 4;
#ifdef __SANITIZE_THREAD__
constexpr int kMostDecoderThreads = 1;  // the thread sanitizer cannot see how dav1d synchronises
#else
constexpr int kMostDecoderThreads = 16;  // more bring nothing at such sizes
#endif

/// Ends what libaom holds.
struct EncoderEnd {
  void operator()(aom_codec_ctx_t* codec) const {
    aom_codec_destroy(codec);
    delete codec;
  }
};
using Encoder = std::unique_ptr<aom_codec_ctx_t, EncoderEnd>;

/// One frame: its luma is a slice.
class Frame {
 public:
  Frame(int width, int height)
      : image_(aom_img_alloc(nullptr, AOM_IMG_FMT_I420, width, height, 1)) {
    if (!image_) {
      throw Error("there is not enough memory to code a section");
    }
    image_->range = AOM_CR_FULL_RANGE;
    for (const int plane : {AOM_PLANE_U, AOM_PLANE_V}) {
      std::memset(image_->planes[plane], kGrey,
                  static_cast<size_t>(image_->stride[plane]) * ((height + 1) / 2));
    }
  }

  const aom_image_t* of_slice(const std::uint8_t* slice) {
    const size_t width = image_->d_w;
    for (size_t y = 0; y < image_->d_h; ++y) {
      std::memcpy(image_->planes[AOM_PLANE_Y] + y * image_->stride[AOM_PLANE_Y], slice + y * width,
                  width);
    }
    return image_.get();
  }

 private:
  struct End {
    void operator()(aom_image_t* image) const { aom_img_free(image); }
  };
  std::unique_ptr<aom_image_t, End> image_;
};

void check(aom_codec_err_t outcome) {
  if (outcome != AOM_CODEC_OK) {
    throw Error("a section cannot be coded as AV1 ({})", aom_codec_err_to_string(outcome));
  }
}

Encoder make_encoder(const IVec3& dims, int level) {
  aom_codec_iface_t* const av1 = aom_codec_av1_cx();
  aom_codec_enc_cfg_t config;
  check(aom_codec_enc_config_default(av1, &config, AOM_USAGE_GOOD_QUALITY));
  config.g_w = static_cast<unsigned>(dims.x);
  config.g_h = static_cast<unsigned>(dims.y);
  config.g_threads = kEncoderThreads;
  config.g_lag_in_frames = 35;  // looks as far ahead as it can
  config.rc_end_usage = AOM_Q;
  config.kf_max_dist = static_cast<unsigned>(dims.z);  // nobody seeks
  auto codec = std::make_unique<aom_codec_ctx_t>();
  check(aom_codec_enc_init(codec.get(), av1, &config, 0));
  Encoder encoder(codec.release());
  const auto set = [&](int what, int value) {
    check(aom_codec_control(encoder.get(), what, value));
  };
  set(AOME_SET_CPUUSED, kSpeed);
  set(AOME_SET_CQ_LEVEL, level);
  set(AV1E_SET_ROW_MT, 1);
  set(AV1E_SET_COLOR_RANGE, AOM_CR_FULL_RANGE);
  // At qualities like these neither of the two saves a byte, and the first one takes more stack
  // than dav1d has where it is compiled to WebAssembly.
  set(AV1E_SET_ENABLE_RESTORATION, 0);
  set(AV1E_SET_ENABLE_CDEF, 0);
  return encoder;
}

/// Appends what the encoder has finished; whether there was something.
bool take_packets(aom_codec_ctx_t* encoder, Bytes& stream) {
  bool any = false;
  aom_codec_iter_t at = nullptr;
  while (const aom_codec_cx_pkt_t* packet = aom_codec_get_cx_data(encoder, &at)) {
    if (packet->kind == AOM_CODEC_CX_FRAME_PKT) {
      const auto* const bytes = static_cast<const std::uint8_t*>(packet->data.frame.buf);
      stream.insert(stream.end(), bytes, bytes + packet->data.frame.sz);
      any = true;
    }
  }
  return any;
}

/// dav1d, for frames of one size.
class Decoder {
 public:
  explicit Decoder(const IVec3& dims, std::string name) : dims_(dims), name_(std::move(name)) {
    Dav1dSettings settings;
    dav1d_default_settings(&settings);
    settings.n_threads = std::min(thread_count(), kMostDecoderThreads);
    settings.frame_size_limit = static_cast<unsigned>(dims.x) * static_cast<unsigned>(dims.y);
    settings.logger.callback = nullptr;
    if (dav1d_open(&context_, &settings) < 0) {
      throw Error("{}: cannot be decoded: there is not enough memory", name_);
    }
  }
  ~Decoder() {
    dav1d_data_unref(&data_);
    dav1d_close(&context_);
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  std::vector<std::uint8_t> decode(std::span<const std::uint8_t> stream) {
    std::uint8_t* const copy = dav1d_data_create(&data_, stream.size());
    if (copy == nullptr) {
      fail();
    }
    std::ranges::copy(stream, copy);
    while (data_.sz > 0) {
      const int sent = dav1d_send_data(context_, &data_);
      if (sent < 0 && sent != DAV1D_ERR(EAGAIN)) {
        fail();
      }
      if (!take_picture() && sent < 0) {
        fail();  // it takes nothing and has nothing
      }
    }
    while (take_picture()) {
    }
    if (slices_ != dims_.z) {
      throw Error("{}: has {} slices, {} were expected; the file is corrupt", name_, slices_,
                  dims_.z);
    }
    return std::move(voxels_);
  }

 private:
  [[noreturn]] void fail() const {
    throw Error("{}: cannot be decoded as AV1; the file is corrupt", name_);
  }

  /// Appends a slice, if there is one.
  bool take_picture() {
    Dav1dPicture picture{};
    const int outcome = dav1d_get_picture(context_, &picture);
    if (outcome == DAV1D_ERR(EAGAIN)) {
      return false;
    }
    if (outcome < 0) {
      fail();
    }
    const bool fits = picture.p.w == dims_.x && picture.p.h == dims_.y && picture.p.bpc == 8 &&
                      picture.p.layout == DAV1D_PIXEL_LAYOUT_I420 && slices_ < dims_.z;
    const auto* row = static_cast<const std::uint8_t*>(picture.data[0]);
    for (int y = 0; fits && y < dims_.y; ++y, row += picture.stride[0]) {
      voxels_.insert(voxels_.end(), row, row + dims_.x);
    }
    dav1d_picture_unref(&picture);
    if (!fits) {
      throw Error("{}: has other slices than {} of {} × {}; the file is corrupt", name_, dims_.z,
                  dims_.x, dims_.y);
    }
    ++slices_;
    return true;
  }

  IVec3 dims_;
  std::string name_;
  Dav1dContext* context_ = nullptr;
  Dav1dData data_{};
  std::vector<std::uint8_t> voxels_;
  int slices_ = 0;
};

}  // namespace

Bytes encode_av1(std::span<const std::uint8_t> voxels, const IVec3& dims, int level) {
  const Encoder encoder = make_encoder(dims, level);
  Frame frame(dims.x, dims.y);
  Bytes stream;
  const size_t slice = static_cast<size_t>(dims.x) * static_cast<size_t>(dims.y);
  for (int z = 0; z < dims.z; ++z) {
    check(aom_codec_encode(encoder.get(), frame.of_slice(&voxels[static_cast<size_t>(z) * slice]),
                           z, 1, 0));
    take_packets(encoder.get(), stream);
  }
  do {
    check(aom_codec_encode(encoder.get(), nullptr, 0, 0, 0));
  } while (take_packets(encoder.get(), stream));
  return stream;
}

std::vector<std::uint8_t> decode_av1(std::span<const std::uint8_t> stream, const IVec3& dims,
                                     const std::string& name) {
  if (stream.empty()) {
    throw Error("{}: is empty; the file is corrupt", name);
  }
  return Decoder(dims, name).decode(stream);
}

}  // namespace clipgs
