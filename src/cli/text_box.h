#pragma once

#include <cairo.h>
#include <string>
#include <vector>

namespace clipgs {

/// Lines in a box of their own, letters of that size: the first of them bold if `titled`.
class TextBox {
 public:
  TextBox(cairo_t* cairo, std::vector<std::string> lines, double size, bool titled);

  double width() const;
  double height() const;
  /// Its top left corner at (x, y), its ink so opaque.
  void draw(double x, double y, double opacity = 1) const;

 private:
  double text_width() const;
  bool is_bold(size_t line) const { return titled_ && line == 0; }

  cairo_t* cairo_;
  std::vector<std::string> lines_;
  double size_;
  bool titled_;
};

}  // namespace clipgs
