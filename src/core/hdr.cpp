#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "core/image.h"

namespace clipgs {
namespace {

// Radiance's own format (Ward 1991, "Real Pixels"): lines of text, an empty one, the size, and
// scanlines of red, green, blue and a common exponent, each packed on its own.
class HdrReader {
 public:
  HdrReader(std::span<const std::uint8_t> bytes, const std::filesystem::path& path)
      : bytes_(bytes), path_(path) {}

  Image read() {
    const std::string_view magic = line();
    if (magic != "#?RADIANCE" && magic != "#?RGBE") {
      throw Error("{}: not a Radiance HDR picture", path_.string());
    }
    bool rgbe = false;
    for (std::string_view text = line(); !text.empty(); text = line()) {
      rgbe = rgbe || text == "FORMAT=32-bit_rle_rgbe";
    }
    if (!rgbe) {
      damaged("its FORMAT is not 32-bit_rle_rgbe");
    }
    const auto [width, height] = size_of(line());
    require_enough(width, height);
    Image image(width, height, 3);
    std::vector<Rgbe> row(static_cast<size_t>(width));
    for (int y = 0; y < height; ++y) {
      read_row(row);
      for (int x = 0; x < width; ++x) {
        to_linear(row[static_cast<size_t>(x)], image.at(x, y));
      }
    }
    return image;
  }

 private:
  using Rgbe = std::array<std::uint8_t, 4>;
  static constexpr int kMostSide = 16384;
  static constexpr int kLeastPacked = 8;  // pixels; narrower pictures are not packed
  static constexpr std::uint8_t kLongestCopy = 128;

  struct Size {
    int width;
    int height;
  };

  [[noreturn]] void damaged(std::string_view why) const {
    throw Error("{}: damaged HDR picture ({})", path_.string(), why);
  }

  std::uint8_t byte() {
    if (at_ >= bytes_.size()) {
      damaged("it ends too early");
    }
    return bytes_[at_++];
  }

  std::string_view line() {
    constexpr size_t kLongest = 1024;
    const size_t begin = at_;
    while (byte() != '\n') {
      if (at_ - begin > kLongest) {
        damaged("a line of its header does not end");
      }
    }
    return {reinterpret_cast<const char*>(&bytes_[begin]), at_ - 1 - begin};
  }

  /// "-Y 512 +X 1024": from the top left, row by row.
  Size size_of(std::string_view text) const {
    Size size{};
    const char* const end = text.data() + text.size();
    if (text.starts_with("-Y ")) {
      const auto rows = std::from_chars(text.data() + 3, end, size.height);
      const std::string_view rest(rows.ptr, static_cast<size_t>(end - rows.ptr));
      if (rest.starts_with(" +X ") &&
          std::from_chars(rest.data() + 4, end, size.width).ptr == end &&
          std::min(size.width, size.height) >= 1 &&
          std::max(size.width, size.height) <= kMostSide) {
        return size;
      }
    }
    damaged("its size is not said as -Y HEIGHT +X WIDTH, of 1 to 16384");
  }

  static bool may_be_packed(size_t width) { return width >= kLeastPacked; }

  /// Before anything is allocated: at best a run of 127 takes two bytes.
  void require_enough(int width, int height) const {
    const auto pixels = static_cast<std::uint64_t>(width);
    const std::uint64_t row = may_be_packed(pixels) ? 4 + 8 * ((pixels + 126) / 127) : 4 * pixels;
    if (bytes_.size() - at_ < row * static_cast<std::uint64_t>(height)) {
      damaged("it ends too early");
    }
  }

  void read_row(std::vector<Rgbe>& row) {
    const size_t width = row.size();
    Rgbe first{byte(), byte(), byte(), byte()};
    if (may_be_packed(width) && first[0] == 2 && first[1] == 2 && first[2] < 128) {
      if (static_cast<size_t>(first[2] << 8U | first[3]) != width) {
        damaged("a row of another width");
      }
      for (size_t channel = 0; channel < 4; ++channel) {
        unpack(row, channel);
      }
      return;
    }
    row[0] = first;
    for (size_t x = 1; x < width; ++x) {
      row[x] = {byte(), byte(), byte(), byte()};
    }
  }

  void unpack(std::vector<Rgbe>& row, size_t channel) {
    for (size_t x = 0; x < row.size();) {
      const std::uint8_t code = byte();
      const bool run = code > kLongestCopy;
      const size_t count = run ? code - kLongestCopy : code;
      if (count == 0 || count > row.size() - x) {
        damaged("a run that does not fit its row");
      }
      std::uint8_t value = run ? byte() : 0;
      for (const size_t end = x + count; x < end; ++x) {
        value = run ? value : byte();
        row[x][channel] = value;
      }
    }
  }

  static void to_linear(const Rgbe& pixel, float* out) {
    constexpr int kExponentOfUnit = 128 + 8;
    const float scale = pixel[3] == 0 ? 0.0f : std::ldexp(1.0f, pixel[3] - kExponentOfUnit);
    for (size_t channel = 0; channel < 3; ++channel) {
      out[channel] = static_cast<float>(pixel[channel]) * scale;
    }
  }

  std::span<const std::uint8_t> bytes_;
  const std::filesystem::path& path_;
  size_t at_ = 0;
};

}  // namespace

Image read_hdr(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> bytes = read_file(path);
  return HdrReader(bytes, path).read();
}

}  // namespace clipgs
