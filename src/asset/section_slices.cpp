#include "asset/section_slices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "asset/av1.h"
#include "core/error.h"

namespace clipgs {

namespace {

constexpr int kMaxImage = 16383;  // px a side, of WebP
// Side of the blocks that lossy WebP codes: slices do not share one.
constexpr int kBlock = 16;
constexpr const char* kImageFile = "section.webp";
constexpr const char* kVideoFile = "section.obu";
constexpr const char* kCodingKey = "coding";
constexpr const char* kVideoCoding = "av1";

/// How slices lie in one image: row by row, each padded to whole blocks by its last voxels.
struct Mosaic {
  int tile_width;
  int tile_height;
  int columns;
  int rows;

  explicit Mosaic(const IVec3& dims)
      : tile_width(whole_blocks(dims.x)), tile_height(whole_blocks(dims.y)) {
    const double square = std::sqrt(static_cast<double>(dims.z) * tile_height / tile_width);
    columns = std::clamp(static_cast<int>(std::ceil(square)), 1,
                         std::min(dims.z, kMaxImage / tile_width));
    rows = (dims.z + columns - 1) / columns;
  }
  int width() const { return columns * tile_width; }
  int height() const { return rows * tile_height; }

  /// Texel of voxel (x, y) of slice z; x and y may lie in the padding.
  size_t texel(int x, int y, int z) const {
    const size_t row = static_cast<size_t>(z / columns) * tile_height + y;
    return row * width() + static_cast<size_t>(z % columns) * tile_width + x;
  }

 private:
  static int whole_blocks(int n) { return (n + kBlock - 1) / kBlock * kBlock; }
};

Texels to_texels(const Section& section, const Mosaic& mosaic) {
  Texels texels(mosaic.width(), mosaic.height());
  for (int z = 0; z < section.dims.z; ++z) {
    for (int y = 0; y < mosaic.tile_height; ++y) {
      for (int x = 0; x < mosaic.tile_width; ++x) {
        const int from_x = std::min(x, section.dims.x - 1);
        const int from_y = std::min(y, section.dims.y - 1);
        const size_t voxel = section.offset(from_x, from_y, z) * section.channels;
        std::uint8_t* to = &texels.rgba[4 * mosaic.texel(x, y, z)];
        for (int c = 0; c < 3; ++c) {
          to[c] = section.voxels[voxel + (section.channels == 3 ? c : 0)];
        }
      }
    }
  }
  return texels;
}

/// By itself: texels take four times as much as voxels, and decoding takes as much again.
Bytes encode_image(const Section& section, const Mosaic& mosaic, float quality, Saving saving) {
  const Texels texels = to_texels(section, mosaic);
  return quality >= kLossless ? encode_webp(texels, saving)
                              : encode_webp_data(texels, quality, saving);
}

std::vector<std::uint8_t> to_voxels(const Texels& texels, const Mosaic& mosaic, const IVec3& dims,
                                    int channels) {
  std::vector<std::uint8_t> voxels(static_cast<size_t>(dims.x) * dims.y * dims.z * channels);
  std::uint8_t* to = voxels.data();
  for (int z = 0; z < dims.z; ++z) {
    for (int y = 0; y < dims.y; ++y) {
      for (int x = 0; x < dims.x; ++x) {
        const std::uint8_t* from = &texels.rgba[4 * mosaic.texel(x, y, z)];
        for (int c = 0; c < channels; ++c) {
          *to++ = from[c];
        }
      }
    }
  }
  return voxels;
}

std::vector<std::uint8_t> image_voxels(const Bytes& image, const Mosaic& mosaic, const IVec3& dims,
                                       int channels, const std::string& name) {
  return to_voxels(decode_webp(image, mosaic.width(), mosaic.height(), name), mosaic, dims,
                   channels);
}

/// The quantizer that loses as much of scans as WebP of a quality does (docs/benchmarks.md).
int video_level(float quality) {
  struct Step {
    float quality;
    float level;
  };
  constexpr std::array kSteps = {Step{100, 2}, Step{97, 6},  Step{94, 9},  Step{90, 13},
                                 Step{85, 18}, Step{80, 22}, Step{70, 28}, Step{0, kCoarsestAv1}};
  size_t k = 1;
  while (quality < kSteps[k].quality) {
    ++k;
  }
  const Step& above = kSteps[k - 1];
  const Step& below = kSteps[k];
  const float t = (above.quality - quality) / (above.quality - below.quality);
  return static_cast<int>(std::lround(std::lerp(above.level, below.level, t)));
}

}  // namespace

CodedSlices as_video(const Section& section, float quality) {
  CodedSlices coded;
  coded.video = true;
  coded.file = {kVideoFile, encode_av1(section.voxels, section.dims, video_level(quality))};
  coded.voxels = decode_av1(coded.file.bytes, section.dims, kVideoFile);
  coded.keys = {{kCodingKey, kVideoCoding}, {"file", kVideoFile}};
  return coded;
}

CodedSlices as_image(const Section& section, float quality, Saving saving) {
  const Mosaic mosaic(section.dims);
  if (mosaic.width() > kMaxImage || mosaic.height() > kMaxImage) {
    throw Error("a section of {} × {} × {} voxels does not fit into an image; make it smaller",
                section.dims.x, section.dims.y, section.dims.z);
  }
  CodedSlices coded;
  coded.file = {kImageFile, encode_image(section, mosaic, quality, saving)};
  coded.voxels = image_voxels(coded.file.bytes, mosaic, section.dims, section.channels, kImageFile);
  coded.keys = {{"tile", {mosaic.tile_width, mosaic.tile_height}},
                {"columns", mosaic.columns},
                {"file", kImageFile}};
  return coded;
}

bool is_video(const Section& section, float quality, Saving saving) {
  return section.channels == 1 && quality < kLossless && saving == Saving::kBytes;
}

CodedSlices encode_slices(const Section& section, float quality, Saving saving) {
  return is_video(section, quality, saving) ? as_video(section, quality)
                                            : as_image(section, quality, saving);
}

std::vector<std::uint8_t> decode_slices(const JsonReader& reader, const Bytes& file,
                                        const IVec3& dims, int channels, const std::string& name) {
  if (reader.has(kCodingKey)) {
    if (reader.text(kCodingKey) != kVideoCoding || channels != 1) {
      reader.fail(kCodingKey);
    }
    return decode_av1(file, dims, name + ": its video");
  }
  const Mosaic mosaic(dims);
  if (reader.integer("columns", 1, kMaxImage) != mosaic.columns) {
    reader.fail("columns");
  }
  if (reader.vector<2>("tile") != Vec2(mosaic.tile_width, mosaic.tile_height)) {
    reader.fail("tile");
  }
  return image_voxels(file, mosaic, dims, channels, name + ": its image");
}

}  // namespace clipgs
