#include "cli/caption.h"

#include <algorithm>
#include <cairo.h>
#include <memory>
#include <vector>

#include "core/draw_text.h"

namespace clipgs {

namespace {

constexpr double kRoom = 0.55;  // of the width, beside the warning
constexpr const char* kWarning = "Not for diagnosis";
constexpr double kLineHeight = 1.35;  // of the letters' size

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

double width_of(cairo_t* cairo, const std::string& text, double size, bool bold) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text.c_str(), &extents);
  return extents.x_advance;
}

/// Lines that are no wider than `room`, but for words that are.
std::vector<std::string> lines_of(cairo_t* cairo, const std::string& text, double size,
                                  double room) {
  std::vector<std::string> lines(1);
  std::string word;
  const auto end_word = [&] {
    std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (lines.back().empty() || width_of(cairo, longer, size, false) <= room) {
      lines.back() = std::move(longer);
    } else {
      lines.push_back(word);
    }
    word.clear();
  };
  for (const char c : text) {
    if (c == '\n') {
      end_word();
      lines.emplace_back();
    } else if (c == ' ') {
      end_word();
    } else {
      word += c;
    }
  }
  end_word();
  std::erase(lines, "");
  return lines;
}

/// Lines in a box of their own, its corner at (x, y): the first of them bold if `titled`.
class TextBox {
 public:
  TextBox(cairo_t* cairo, std::vector<std::string> lines, double size, bool titled)
      : cairo_(cairo), lines_(std::move(lines)), size_(size), titled_(titled) {}

  double height() const {
    return static_cast<double>(lines_.size()) * kLineHeight * size_ + 0.8 * size_;
  }

  double width() const { return text_width() + 1.4 * size_; }

  void draw(double x, double y) const {
    const double room = text_width() + 1;
    cairo_set_source_rgba(cairo_, 0.07, 0.09, 0.12, 0.82);
    cairo_rectangle(cairo_, x, y, width(), height());
    cairo_fill(cairo_);
    cairo_set_source_rgb(cairo_, 0.93, 0.95, 0.97);
    for (size_t i = 0; i < lines_.size(); ++i) {
      const double base = y + 0.4 * size_ + (static_cast<double>(i) + 0.8) * kLineHeight * size_;
      draw_text(cairo_, lines_[i], x + 0.7 * size_, base, size_, Align::kLeft, room, is_bold(i));
    }
  }

 private:
  double text_width() const {
    double width = 0;
    for (size_t i = 0; i < lines_.size(); ++i) {
      width = std::max(width, width_of(cairo_, lines_[i], size_, is_bold(i)));
    }
    return width;
  }
  bool is_bold(size_t line) const { return titled_ && line == 0; }

  cairo_t* cairo_;
  std::vector<std::string> lines_;
  double size_;
  bool titled_;
};

/// Puts what was drawn over a picture.
void put_over(Image& picture, cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  const unsigned char* const rows = cairo_image_surface_get_data(surface);
  const auto stride = static_cast<size_t>(cairo_image_surface_get_stride(surface));
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      // Premultiplied, blue first.
      const unsigned char* const over =
          rows + static_cast<size_t>(y) * stride + 4 * static_cast<size_t>(x);
      float* const pixel = picture.at(x, y);
      const float cover = static_cast<float>(over[3]) / 255;
      const float below = picture.channels == 4 ? pixel[3] : 1;
      const float alpha = cover + (1 - cover) * below;
      for (int c = 0; cover > 0 && c < 3; ++c) {
        pixel[c] = (static_cast<float>(over[2 - c]) / 255 + (1 - cover) * below * pixel[c]) / alpha;
      }
      if (picture.channels == 4) {
        pixel[3] = alpha;
      }
    }
  }
}

}  // namespace

void draw_caption(Image& picture, const std::string& name, const std::string& text) {
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, picture.width, picture.height),
      cairo_surface_destroy);
  const Context context(cairo_create(surface.get()), cairo_destroy);
  cairo_t* const cairo = context.get();
  const double size = std::max(9.0, 0.026 * std::min(picture.width, picture.height));
  const double room = kRoom * picture.width;
  std::vector<std::string> lines;
  if (!name.empty()) {
    lines.push_back(name);
  }
  for (std::string& line : lines_of(cairo, text, size, room)) {
    lines.push_back(std::move(line));
  }
  if (!lines.empty()) {
    TextBox(cairo, lines, size, !name.empty()).draw(size, size);
  }
  const TextBox warning(cairo, {kWarning}, 0.9 * size, false);
  warning.draw(picture.width - size - warning.width(), size);
  put_over(picture, surface.get());
}

}  // namespace clipgs
