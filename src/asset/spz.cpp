#include "asset/spz.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <zlib.h>
#include <zstd.h>

#include "asset/sog.h"
#include "core/error.h"
#include "splat/similarity.h"
#include "splat/y_up.h"

namespace clipgs {

namespace {

constexpr std::uint32_t kMagic = 0x5053474e;
constexpr std::uint32_t kFirstVersion = 2;
constexpr std::uint32_t kPackedVersion =
    kSpzVersion;  // from here on streams by zstd, before one by gzip
constexpr size_t kHeader = 32;
constexpr size_t kOldHeader = 16;
constexpr int kStreams = 6;
constexpr int kZstdLevel = 19;
constexpr float kColorScale = 0.15f;
constexpr float kScaleStep = 16;  // codes a factor of e
constexpr float kScaleOffset = 10;
constexpr float kShZero = 128;
constexpr int kMostFraction = 24;  // bits
constexpr std::int32_t kMostFixed = (1 << 23) - 1;
constexpr std::uint32_t kRotationMost = 511;  // of nine bits
/// Bits that are kept of SH bytes, of degree 1 and above: as Niantic's own writer has them, finer
/// where it costs little.
constexpr std::array kShBits = {0, 6, 5, 5};

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(std::round(value), 0.0f, 255.0f));
}

void append(Bytes& bytes, const void* data, size_t size) {
  if (size == 0) {
    return;  // of no harmonics, and from nowhere
  }
  const size_t at = bytes.size();
  bytes.resize(at + size);
  std::memcpy(bytes.data() + at, data, size);
}

template <typename T>
void append(Bytes& bytes, T value) {
  append(bytes, &value, sizeof(T));
}

template <typename T>
T take(std::span<const std::uint8_t> bytes, size_t at) {
  T value;
  std::memcpy(&value, &bytes[at], sizeof(T));
  return value;
}

/// The streams of a scene, in their order in the file.
struct Streams {
  Bytes positions, alphas, colors, scales, rotations, sh;
  std::array<Bytes*, kStreams> all() {
    return {&positions, &alphas, &colors, &scales, &rotations, &sh};
  }
};

/// Bits after the point for the farthest coordinate.
int fraction_bits(const Gaussians& gaussians) {
  float farthest = 0;
  for (int a = 0; a < 3; ++a) {
    for (size_t i = 0; i < gaussians.size(); ++i) {
      farthest = std::max(farthest, std::abs(gaussians.plane(Gaussians::kMean + a)[i]));
    }
  }
  int bits = 18;  // 4 µm, within 32 m
  while (bits > 12 && std::ldexp(farthest, bits) >= static_cast<float>(kMostFixed)) {
    --bits;
  }
  if (!(std::ldexp(farthest, bits) < static_cast<float>(kMostFixed))) {
    throw Error("a splat is {:g} m off, farther than SPZ can say; export as .ply", farthest);
  }
  return bits;
}

/// The number of the largest component in two bits, then of each other one a sign and nine bits.
std::uint32_t rotation_code(const Quat& q) {
  const std::array<float, 4> xyzw = {q.x, q.y, q.z, q.w};
  std::uint32_t largest = 0;
  for (std::uint32_t c = 1; c < 4; ++c) {
    largest = std::abs(xyzw[c]) > std::abs(xyzw[largest]) ? c : largest;
  }
  const bool negate = xyzw[largest] < 0;
  std::uint32_t code = largest;
  for (std::uint32_t c = 0; c < 4; ++c) {
    if (c != largest) {
      const float share = std::abs(xyzw[c]) * std::numbers::sqrt2_v<float>;
      const auto size = static_cast<std::uint32_t>(
          std::min(std::lround(share * kRotationMost), static_cast<long>(kRotationMost)));
      code = code << 10 | static_cast<std::uint32_t>((xyzw[c] < 0) != negate) << 9 | size;
    }
  }
  return code;
}

std::array<float, 4> rotation_of(std::uint32_t code) {  // x, y, z, w
  std::array<float, 4> xyzw{};
  const std::uint32_t largest = code >> 30;
  float squares = 0;
  for (std::uint32_t k = 4; k-- > 0;) {
    if (k != largest) {
      const float size =
          static_cast<float>(code & kRotationMost) / kRotationMost / std::numbers::sqrt2_v<float>;
      xyzw[k] = (code & (kRotationMost + 1)) != 0 ? -size : size;
      squares += size * size;
      code >>= 10;
    }
  }
  xyzw[largest] = std::sqrt(std::max(0.0f, 1 - squares));
  return xyzw;
}

/// Of versions before 3: w is what is left.
std::array<float, 4> rotation_of(const std::uint8_t* bytes) {
  std::array<float, 4> xyzw{};
  float squares = 0;
  for (size_t c = 0; c < 3; ++c) {
    xyzw[c] = static_cast<float>(bytes[c]) / 127.5f - 1;
    squares += xyzw[c] * xyzw[c];
  }
  xyzw[3] = std::sqrt(std::max(0.0f, 1 - squares));
  return xyzw;
}

/// The byte of a coefficient, of which so many bits are kept.
std::uint8_t sh_code(float value, int bits) {
  const int step = 1 << (8 - bits);
  const int code = static_cast<int>(std::lround(value * kShZero + kShZero));
  return static_cast<std::uint8_t>(std::clamp((code + step / 2) / step * step, 0, 255));
}

Streams pack(const Gaussians& gaussians, int fraction) {
  Streams streams;
  const int coefficients = sh_coefficients(gaussians.sh_degree());
  for (size_t i = 0; i < gaussians.size(); ++i) {
    for (int a = 0; a < 3; ++a) {
      const float coordinate = std::ldexp(gaussians.plane(Gaussians::kMean + a)[i], fraction);
      const auto fixed =
          static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(coordinate)));
      streams.positions.push_back(static_cast<std::uint8_t>(fixed));
      streams.positions.push_back(static_cast<std::uint8_t>(fixed >> 8));
      streams.positions.push_back(static_cast<std::uint8_t>(fixed >> 16));
      streams.scales.push_back(
          to_byte((gaussians.plane(Gaussians::kLogScale + a)[i] + kScaleOffset) * kScaleStep));
      streams.colors.push_back(
          to_byte(255 * (kColorScale * gaussians.plane(Gaussians::kSh + a)[i] + 0.5f)));
    }
    streams.alphas.push_back(to_byte(255 * gaussians.opacity(i)));
    append(streams.rotations, rotation_code(gaussians.rotation(i)));
    for (int k = 1; k < coefficients; ++k) {
      const int degree = k < 4 ? 1 : k < 9 ? 2 : 3;
      for (int c = 0; c < 3; ++c) {
        streams.sh.push_back(sh_code(gaussians.plane(Gaussians::kSh + 3 * k + c)[i],
                                     kShBits[static_cast<size_t>(degree)]));
      }
    }
  }
  return streams;
}

struct Head {
  std::uint32_t version = 0;
  size_t count = 0;
  int degree = 0;
  int fraction = 0;
};

Head read_head(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.size() < kOldHeader || take<std::uint32_t>(bytes, 0) != kMagic) {
    throw Error("{}: is not an SPZ scene, or it is truncated", name);
  }
  const Head head{take<std::uint32_t>(bytes, 4), take<std::uint32_t>(bytes, 8), bytes[12],
                  bytes[13]};
  if (head.version < kFirstVersion || head.version > kPackedVersion) {
    throw Error("{}: is SPZ of version {}, and 2 to {} can be read; save it as one of these", name,
                head.version, kPackedVersion);
  }
  if (head.count == 0 || head.count > kMaxSplats) {
    throw Error("{}: says that it has {} splats, and 1 to {} can be read", name, head.count,
                kMaxSplats);
  }
  if (head.degree > kMaxShDegree || head.fraction > kMostFraction) {
    throw Error(
        "{}: has harmonics of degree {} and {} bits after the point; up to {} and {} can be "
        "read",
        name, head.degree, head.fraction, kMaxShDegree, kMostFraction);
  }
  return head;
}

/// Gives each stream the bytes that it is to have.
void size_streams(const Head& head, Streams& streams) {
  streams.positions.resize(9 * head.count);
  streams.alphas.resize(head.count);
  streams.colors.resize(3 * head.count);
  streams.scales.resize(3 * head.count);
  streams.rotations.resize((head.version == kFirstVersion ? 3 : 4) * head.count);
  streams.sh.resize(3 * static_cast<size_t>(sh_coefficients(head.degree) - 1) * head.count);
}

[[noreturn]] void fail_damaged(const std::string& name) {
  throw Error("{}: is truncated or corrupt; copy it again", name);
}

void read_packed(std::span<const std::uint8_t> bytes, const std::string& name, Streams& streams) {
  if (bytes.size() < kHeader) {
    fail_damaged(name);
  }
  const size_t stated = bytes[15];
  const auto table = take<std::uint32_t>(bytes, 16);
  constexpr size_t kEntry = 16;
  size_t at = table + stated * kEntry;
  if (table < kHeader || at > bytes.size()) {
    fail_damaged(name);
  }
  size_t stream = 0;
  for (Bytes* const out : streams.all()) {
    if (out->empty() && stream >= stated) {
      continue;  // no harmonics, and no stream of them
    }
    if (stream >= stated) {
      fail_damaged(name);
    }
    const auto packed = take<std::uint64_t>(bytes, table + stream * kEntry);
    const auto plain = take<std::uint64_t>(bytes, table + stream * kEntry + 8);
    ++stream;
    if (plain != out->size() || packed > bytes.size() - at) {
      fail_damaged(name);
    }
    if (!out->empty() &&
        ZSTD_decompress(out->data(), out->size(), &bytes[at], packed) != out->size()) {
      fail_damaged(name);
    }
    at += packed;
  }
}

/// gzip, piece by piece.
class Gunzip {
 public:
  Gunzip(std::span<const std::uint8_t> bytes, const std::string& name) : name_(name) {
    constexpr int kGzip = 16 + MAX_WBITS;
    if (inflateInit2(&stream_, kGzip) != Z_OK) {
      throw Error("{}: cannot be unpacked: there is not enough memory", name);
    }
    stream_.next_in = const_cast<std::uint8_t*>(bytes.data());  // NOLINT: zlib reads it
    stream_.avail_in = static_cast<uInt>(bytes.size());
  }
  ~Gunzip() { inflateEnd(&stream_); }
  Gunzip(const Gunzip&) = delete;
  Gunzip& operator=(const Gunzip&) = delete;

  void fill(Bytes& out) {
    stream_.next_out = out.data();
    stream_.avail_out = static_cast<uInt>(out.size());
    while (stream_.avail_out > 0) {
      const int outcome = inflate(&stream_, Z_NO_FLUSH);
      if (outcome != Z_OK && !(outcome == Z_STREAM_END && stream_.avail_out == 0)) {
        fail_damaged(name_);
      }
    }
  }

 private:
  z_stream stream_{};
  const std::string& name_;
};

Gaussians unpack(const Head& head, Streams& streams) {
  Gaussians gaussians(head.count, head.degree);
  const int coefficients = sh_coefficients(head.degree);
  for (size_t i = 0; i < head.count; ++i) {
    for (size_t a = 0; a < 3; ++a) {
      const std::uint8_t* const p = &streams.positions[3 * (3 * i + a)];
      const auto fixed = static_cast<std::int32_t>(static_cast<std::uint32_t>(p[0]) << 8 |
                                                   static_cast<std::uint32_t>(p[1]) << 16 |
                                                   static_cast<std::uint32_t>(p[2]) << 24);
      const int plane = static_cast<int>(a);
      gaussians.plane(Gaussians::kMean + plane)[i] =
          std::ldexp(static_cast<float>(fixed >> 8), -head.fraction);
      gaussians.plane(Gaussians::kLogScale + plane)[i] =
          static_cast<float>(streams.scales[3 * i + a]) / kScaleStep - kScaleOffset;
      gaussians.plane(Gaussians::kSh + plane)[i] =
          (static_cast<float>(streams.colors[3 * i + a]) / 255 - 0.5f) / kColorScale;
    }
    // What is opaque has no logit.
    constexpr float kHalfStep = 0.5f / 255;
    const float alpha =
        std::clamp(static_cast<float>(streams.alphas[i]) / 255, kHalfStep, 1 - kHalfStep);
    gaussians.plane(Gaussians::kOpacity)[i] = std::log(alpha / (1 - alpha));
    const std::array<float, 4> xyzw =
        head.version == kFirstVersion ? rotation_of(&streams.rotations[3 * i])
                                      : rotation_of(take<std::uint32_t>(streams.rotations, 4 * i));
    for (size_t c = 0; c < 4; ++c) {
      gaussians.plane(Gaussians::kRotation + static_cast<int>((c + 1) % 4))[i] = xyzw[c];
    }
    for (int k = 0; k < 3 * (coefficients - 1); ++k) {
      const std::uint8_t code =
          streams.sh[i * static_cast<size_t>(3 * (coefficients - 1)) + static_cast<size_t>(k)];
      gaussians.plane(Gaussians::kSh + 3 + k)[i] = (static_cast<float>(code) - kShZero) / kShZero;
    }
  }
  return gaussians;
}

Bytes gzipped(Bytes& bytes) {
  z_stream stream{};
  constexpr int kGzip = 16 + MAX_WBITS;
  constexpr int kMemory = 9;
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
    throw Error("an SPZ cannot be packed: there is not enough memory");
  }
  Bytes packed(deflateBound(&stream, bytes.size()));
  stream.next_in = bytes.data();
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = packed.data();
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace

Bytes encode_spz(const Gaussians& scene, int version) {
  const Gaussians gaussians = transform(scene.reshaped(scene.sh_degree(), false), y_up());
  const int fraction = fraction_bits(gaussians);
  Streams streams = pack(gaussians, fraction);
  Bytes file;
  append(file, kMagic);
  append(file, static_cast<std::uint32_t>(version));
  append(file, static_cast<std::uint32_t>(gaussians.size()));
  const bool by_gzip = version == kOldSpzVersion;
  for (const int byte : {gaussians.sh_degree(), fraction, 0, by_gzip ? 0 : kStreams}) {
    file.push_back(static_cast<std::uint8_t>(byte));
  }
  if (by_gzip) {
    for (const Bytes* const stream : streams.all()) {
      append(file, stream->data(), stream->size());
    }
    return gzipped(file);
  }
  append(file, static_cast<std::uint32_t>(kHeader));
  file.resize(kHeader);
  Bytes packed;
  for (const Bytes* const stream : streams.all()) {
    Bytes out(ZSTD_compressBound(stream->size()));
    const size_t size =
        ZSTD_compress(out.data(), out.size(), stream->data(), stream->size(), kZstdLevel);
    if (ZSTD_isError(size) != 0) {
      throw Error("an SPZ cannot be packed ({})", ZSTD_getErrorName(size));
    }
    append(file, static_cast<std::uint64_t>(size));
    append(file, static_cast<std::uint64_t>(stream->size()));
    append(packed, out.data(), size);
  }
  append(file, packed.data(), packed.size());
  return file;
}

Gaussians decode_spz(std::span<const std::uint8_t> bytes, const std::string& name) {
  Streams streams;
  Head head;
  constexpr std::uint8_t kGzipMark = 0x1f;
  if (!bytes.empty() && bytes[0] == kGzipMark) {
    Gunzip gunzip(bytes, name);
    Bytes header(kOldHeader);
    gunzip.fill(header);
    head = read_head(header, name);
    size_streams(head, streams);
    for (Bytes* const stream : streams.all()) {
      gunzip.fill(*stream);
    }
  } else {
    head = read_head(bytes, name);
    size_streams(head, streams);
    read_packed(bytes, name, streams);
  }
  return transform(unpack(head, streams), y_up());
}

}  // namespace clipgs
