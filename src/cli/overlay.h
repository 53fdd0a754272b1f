#pragma once

#include <cairo.h>
#include <memory>
#include <string>
#include <vector>

#include "core/image.h"

namespace clipgs {

/// What is written and drawn over a picture, px from its top left.
class Overlay {
 public:
  Overlay(int width, int height);

  cairo_t* cairo() const { return context_.get(); }
  /// Puts it over a picture of that size: RGB, or RGBA of straight alpha.
  void put_over(Image& picture) const;

 private:
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context_;
};

/// Width of a line of text, in the units of the surface.
double width_of(cairo_t* cairo, const std::string& text, double size, bool bold = false);

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
