#include "cli/text_box.h"

#include <algorithm>

#include "core/draw_text.h"

namespace clipgs {

namespace {

constexpr double kLineHeight = 1.35;  // of the letters' size

}  // namespace

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
