#include "section/annotate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <string_view>

namespace clipgs {
namespace {

constexpr int kGlyphWidth = 5;
constexpr int kGlyphHeight = 7;

/// Seven rows of five bits, the left pixel highest.
struct Glyph {
  char32_t character;
  std::array<std::uint8_t, kGlyphHeight> rows;
};

constexpr std::array kGlyphs = {
    Glyph{U'0', {14, 17, 19, 21, 25, 17, 14}}, Glyph{U'1', {4, 12, 4, 4, 4, 4, 14}},
    Glyph{U'2', {14, 17, 1, 2, 4, 8, 31}},     Glyph{U'3', {31, 2, 4, 2, 1, 17, 14}},
    Glyph{U'4', {2, 6, 10, 18, 31, 2, 2}},     Glyph{U'5', {31, 16, 30, 1, 1, 17, 14}},
    Glyph{U'6', {6, 8, 16, 30, 17, 17, 14}},   Glyph{U'7', {31, 1, 2, 4, 8, 8, 8}},
    Glyph{U'8', {14, 17, 17, 14, 17, 17, 14}}, Glyph{U'9', {14, 17, 17, 15, 1, 2, 12}},
    Glyph{U'-', {0, 0, 0, 31, 0, 0, 0}},       Glyph{U'.', {0, 0, 0, 0, 0, 12, 12}},
    Glyph{U'±', {4, 4, 31, 4, 4, 0, 31}},      Glyph{U'A', {14, 17, 17, 31, 17, 17, 17}},
    Glyph{U'C', {14, 17, 16, 16, 16, 17, 14}}, Glyph{U'H', {17, 17, 17, 31, 17, 17, 17}},
    Glyph{U'I', {14, 4, 4, 4, 4, 4, 14}},      Glyph{U'L', {16, 16, 16, 16, 16, 16, 31}},
    Glyph{U'P', {30, 17, 17, 30, 16, 16, 16}}, Glyph{U'R', {30, 17, 17, 30, 20, 18, 17}},
    Glyph{U'S', {15, 16, 16, 14, 1, 1, 30}},   Glyph{U'U', {17, 17, 17, 17, 17, 17, 14}},
    Glyph{U'W', {17, 17, 17, 21, 21, 21, 10}}, Glyph{U'd', {1, 1, 13, 19, 17, 17, 15}},
    Glyph{U'e', {0, 0, 14, 17, 31, 16, 14}},   Glyph{U'i', {4, 0, 12, 4, 4, 4, 14}},
    Glyph{U'm', {0, 0, 26, 21, 21, 17, 17}},   Glyph{U'o', {0, 0, 14, 17, 17, 17, 14}},
    Glyph{U's', {0, 0, 14, 16, 14, 1, 30}},    Glyph{U't', {8, 8, 28, 8, 8, 9, 6}},
    Glyph{U'u', {0, 0, 17, 17, 17, 19, 13}}};

/// UTF-8 of up to two bytes, which is all that is written here.
std::u32string characters(std::string_view text) {
  std::u32string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (byte >= 0xC0 && i + 1 < text.size()) {
      result += static_cast<char32_t>((byte & 0x1FU) << 6U |
                                      (static_cast<unsigned char>(text[++i]) & 0x3FU));
    } else {
      result += static_cast<char32_t>(byte);
    }
  }
  return result;
}

/// White marks with a dark rim, so that they are read on anything.
class Pen {
 public:
  explicit Pen(Image& picture) : picture_(picture), size_(std::max(1, picture.height / 256)) {}

  int size() const { return size_; }
  int text_height() const { return kGlyphHeight * size_; }
  int text_width(std::string_view text) const {
    return static_cast<int>(characters(text).size()) * (kGlyphWidth + 1) * size_ - size_;
  }

  /// A filled box, px; what lies beyond the picture is not drawn.
  void box(int left, int top, int width, int height) {
    fill(left - size_, top - size_, width + 2 * size_, height + 2 * size_, 0);
    fill(left, top, width, height, 1);
  }

  /// Text with its top left corner at (x, y).
  void text(int x, int y, std::string_view text) {
    for (const float shade : {0.0f, 1.0f}) {
      const int rim = shade > 0 ? 0 : size_;
      int at = x;
      for (const char32_t character : characters(text)) {
        draw(at, y, character, rim, shade);
        at += (kGlyphWidth + 1) * size_;
      }
    }
  }

 private:
  void draw(int x, int y, char32_t character, int rim, float shade) {
    const auto* const glyph = std::ranges::find(kGlyphs, character, &Glyph::character);
    for (int row = 0; glyph != kGlyphs.end() && row < kGlyphHeight; ++row) {
      for (int column = 0; column < kGlyphWidth; ++column) {
        if ((glyph->rows[static_cast<size_t>(row)] >> (kGlyphWidth - 1 - column) & 1) != 0) {
          fill(x + column * size_ - rim, y + row * size_ - rim, size_ + 2 * rim, size_ + 2 * rim,
               shade);
        }
      }
    }
  }

  void fill(int left, int top, int width, int height, float shade) {
    for (int y = std::max(0, top); y < std::min(picture_.height, top + height); ++y) {
      for (int x = std::max(0, left); x < std::min(picture_.width, left + width); ++x) {
        float* rgba = picture_.at(x, y);
        std::fill(rgba, rgba + 3, shade);
        rgba[3] = 1;
      }
    }
  }

  Image& picture_;
  int size_;  // px of a glyph's pixel
};

/// The point of the face, or of the section, that a length is true at.
Vec3 middle(const Section& section, const Cut& cut) {
  Vec3 point = section.world_from_index(0.5f * Vec3(section.dims - 1));
  for (const Plane& plane : cut.planes()) {
    point -= plane.signed_distance(point) * plane.normal;
  }
  return point;
}

void draw_scale_bar(Pen& pen, const Image& picture, float pixels_per_mm) {
  constexpr std::array kLengths = {500, 200, 100, 50, 20, 10, 5, 2, 1};
  const float most = 0.25f * static_cast<float>(picture.width);
  const auto* const fits = std::ranges::find_if(
      kLengths, [&](int mm) { return static_cast<float>(mm) * pixels_per_mm <= most; });
  const int mm = fits != kLengths.end() ? *fits : kLengths.back();
  const int width = static_cast<int>(std::lround(static_cast<float>(mm) * pixels_per_mm));
  const int margin = 3 * pen.size() + pen.text_height();
  const int left = picture.width - margin - width;
  const int bottom = picture.height - margin;
  pen.box(left, bottom, width, pen.size());
  const std::string text = fmt::format("{} mm", mm);
  pen.text(left + (width - pen.text_width(text)) / 2, bottom - pen.text_height() - 3 * pen.size(),
           text);
}

void draw_directions(Pen& pen, const Image& picture, const Camera& camera) {
  const Vec3 right = Vec3(1, 0, 0) * camera.rotation;
  const Vec3 down = Vec3(0, 1, 0) * camera.rotation;
  const int margin = 3 * pen.size();
  const auto centered = [&](const std::string& text, int size) {
    return (size - pen.text_width(text)) / 2;
  };
  const std::string to_right = direction_letters(right);
  const std::string to_bottom = direction_letters(down);
  const std::string to_top = direction_letters(-down);
  const int middle_row = (picture.height - pen.text_height()) / 2;
  pen.text(margin, middle_row, direction_letters(-right));
  pen.text(picture.width - margin - pen.text_width(to_right), middle_row, to_right);
  pen.text(centered(to_top, picture.width), margin, to_top);
  pen.text(centered(to_bottom, picture.width), picture.height - margin - pen.text_height(),
           to_bottom);
}

}  // namespace

std::string direction_letters(const Vec3& direction) {
  constexpr float kWeak = 0.3f;
  struct Part {
    float strength;
    char letter;
  };
  constexpr std::array<const char*, 3> kLetters = {"RL", "AP", "SI"};
  std::array<Part, 3> parts{};
  for (int k = 0; k < 3; ++k) {
    const char* letters = kLetters[static_cast<size_t>(k)];
    parts[static_cast<size_t>(k)] = {std::abs(direction[k]), letters[direction[k] < 0 ? 1 : 0]};
  }
  std::ranges::stable_sort(parts, std::ranges::greater(), &Part::strength);
  std::string text;
  for (const Part& part : parts) {
    if (part.strength > kWeak || text.empty()) {
      text += part.letter;
    }
  }
  return text;
}

std::string value_text(const Section& section, const Vec3& point) {
  const std::optional<Section::Reading> reading = section.read(point);
  if (!reading) {
    return "outside";
  }
  return fmt::format("{:.0f} ± {:.{}f}{}", reading->value + 0.0f, reading->error,
                     reading->error < 0.95f ? 1 : 0,
                     section.modality == Modality::kCt ? " HU" : "");
}

void annotate(Image& picture, const Section& section, const Camera& camera, const Cut& cut,
              const FaceStyle& style, std::span<const Vec3> pins) {
  Pen pen(picture);
  draw_directions(pen, picture, camera);
  const Vec3 at = camera.to_camera(middle(section, cut));
  if (at.z > 0) {
    draw_scale_bar(pen, picture, camera.fx / at.z);
  }
  if (style.grey > 0 && section.channels == 1) {
    pen.text(3 * pen.size(), picture.height - 3 * pen.size() - pen.text_height(),
             fmt::format("C {:.0f} W {:.0f}", style.window.center, style.window.width));
  }
  for (const Vec3& pin : pins) {
    const Vec3 local = camera.to_camera(pin);
    if (local.z <= 0) {
      continue;
    }
    const int x = static_cast<int>(std::floor(camera.fx * local.x / local.z + camera.cx));
    const int y = static_cast<int>(std::floor(camera.fy * local.y / local.z + camera.cy));
    const int arm = 3 * pen.size();
    pen.box(x - arm, y, 2 * arm + 1, 1);
    pen.box(x, y - arm, 1, 2 * arm + 1);
    pen.text(x + 2 * arm, y - pen.text_height() / 2, value_text(section, pin));
  }
}

}  // namespace clipgs
