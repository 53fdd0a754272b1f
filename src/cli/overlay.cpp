#include "cli/overlay.h"

#include <algorithm>

#include "core/draw_text.h"

namespace clipgs {

namespace {

constexpr double kLineHeight = 1.35;  // of the letters' size

}  // namespace

Overlay::Overlay(int width, int height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height),
               cairo_surface_destroy),
      context_(cairo_create(surface_.get()), cairo_destroy) {}

void Overlay::put_over(Image& picture) const {
  cairo_surface_t* const surface = surface_.get();
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

double width_of(cairo_t* cairo, const std::string& text, double size, bool bold) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text.c_str(), &extents);
  return extents.x_advance;
}

TextBox::TextBox(cairo_t* cairo, std::vector<std::string> lines, double size, bool titled)
    : cairo_(cairo), lines_(std::move(lines)), size_(size), titled_(titled) {}

double TextBox::height() const {
  return static_cast<double>(lines_.size()) * kLineHeight * size_ + 0.8 * size_;
}

double TextBox::width() const { return text_width() + 1.4 * size_; }

double TextBox::text_width() const {
  double width = 0;
  for (size_t i = 0; i < lines_.size(); ++i) {
    width = std::max(width, width_of(cairo_, lines_[i], size_, is_bold(i)));
  }
  return width;
}

void TextBox::draw(double x, double y, double opacity) const {
  const double room = text_width() + 1;
  cairo_set_source_rgba(cairo_, 0.07, 0.09, 0.12, 0.82 * opacity);
  cairo_rectangle(cairo_, x, y, width(), height());
  cairo_fill(cairo_);
  cairo_set_source_rgba(cairo_, 0.93, 0.95, 0.97, opacity);
  for (size_t i = 0; i < lines_.size(); ++i) {
    const double base = y + 0.4 * size_ + (static_cast<double>(i) + 0.8) * kLineHeight * size_;
    draw_text(cairo_, lines_[i], x + 0.7 * size_, base, size_, Align::kLeft, room, is_bold(i));
  }
}

}  // namespace clipgs
