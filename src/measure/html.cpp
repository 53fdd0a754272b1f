#include "measure/html.h"

#include <algorithm>
#include <cstdint>

#include "asset/webp.h"

namespace clipgs {

namespace {

std::string base64(const std::uint8_t* data, size_t size) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (size_t i = 0; i < size; i += 3) {
    const size_t count = std::min<size_t>(3, size - i);
    std::uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) {
      bits = bits << 8U | (k < count ? data[i + k] : 0U);
    }
    for (size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[bits >> (18U - 6U * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace

std::string escape_html(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string data_uri(const Image& rgb) {
  constexpr float kQuality = 95;
  const Bytes webp = encode_webp(rgb, kQuality);
  return "data:image/webp;base64," + base64(webp.data(), webp.size());
}

Image heat_map(const Image& grey) {
  Image out(grey.width, grey.height, 3);
  for (size_t i = 0; i < grey.pixels(); ++i) {
    const float t = 3.0f * std::clamp(grey.data[i], 0.0f, 1.0f);
    for (int c = 0; c < 3; ++c) {
      out.data[i * 3 + c] = std::clamp(t - static_cast<float>(c), 0.0f, 1.0f);
    }
  }
  return out;
}

}  // namespace clipgs
