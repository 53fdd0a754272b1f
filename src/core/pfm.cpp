#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/image.h"

namespace clipgs {
namespace {

// Debevec's portable float map: "PF" (RGB) or "Pf" (grey), width, height and a scale, then floats
// from the lowest row up, little-endian where the scale is negative.
class PfmReader {
 public:
  PfmReader(std::span<const std::uint8_t> bytes, const std::filesystem::path& path)
      : bytes_(bytes), path_(path) {}

  Image read() {
    const std::string_view magic = word();
    if (magic != "PF" && magic != "Pf") {
      throw Error("{}: not a PFM picture", path_.string());
    }
    const size_t channels = magic == "PF" ? 3 : 1;
    const int width = side();
    const int height = side();
    const bool little = is_little_endian();
    const std::uint64_t row = sizeof(float) * channels * static_cast<std::uint64_t>(width);
    if (bytes_.size() - at_ < row * static_cast<std::uint64_t>(height)) {
      damaged("it ends too early");
    }
    Image image(width, height, 3);
    for (int y = height - 1; y >= 0; --y) {
      for (int x = 0; x < width; ++x) {
        read_pixel(channels, little, image.at(x, y));
      }
    }
    return image;
  }

 private:
  static constexpr int kMostSide = 16384;
  static constexpr size_t kLongestWord = 64;

  [[noreturn]] void damaged(std::string_view why) const {
    throw Error("{}: damaged PFM picture ({})", path_.string(), why);
  }

  /// Up to white space, of which the first character is taken too: pixels follow the last.
  std::string_view word() {
    const auto is_space = [](std::uint8_t c) { return c == ' ' || c == '\n' || c == '\r'; };
    const size_t begin = at_;
    while (at_ < bytes_.size() && at_ - begin < kLongestWord && !is_space(bytes_[at_])) {
      ++at_;
    }
    if (at_ == bytes_.size() || !is_space(bytes_[at_])) {
      damaged("its header ends too early");
    }
    return {reinterpret_cast<const char*>(bytes_.data()) + begin, at_++ - begin};
  }

  int side() {
    const std::string_view text = word();
    int value = 0;
    if (std::from_chars(text.begin(), text.end(), value).ptr != text.end() || value < 1 ||
        value > kMostSide) {
      damaged("its size is not said as WIDTH HEIGHT, of 1 to 16384");
    }
    return value;
  }

  /// The scale's size is a unit that nobody agrees on; its sign is all that counts.
  bool is_little_endian() {
    const std::string_view text = word();
    float scale = 0;
    if (std::from_chars(text.begin(), text.end(), scale).ptr != text.end() || scale == 0 ||
        !std::isfinite(scale)) {
      damaged("its scale is no number other than 0");
    }
    return scale < 0;
  }

  void read_pixel(size_t channels, bool little, float* out) {
    for (size_t c = 0; c < channels; ++c) {
      std::uint32_t bits = 0;
      for (size_t i = 0; i < sizeof(bits); ++i) {
        bits |= std::uint32_t{bytes_[at_++]} << 8 * (little ? i : 3 - i);
      }
      out[c] = std::bit_cast<float>(bits);
    }
    for (size_t c = channels; c < 3; ++c) {
      out[c] = out[0];
    }
  }

  std::span<const std::uint8_t> bytes_;
  const std::filesystem::path& path_;
  size_t at_ = 0;
};

}  // namespace

Image read_pfm(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> bytes = read_file(path);
  return PfmReader(bytes, path).read();
}

}  // namespace clipgs
