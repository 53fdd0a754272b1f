#pragma once

#include <cairo.h>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/image.h"

namespace clipgs {

enum class Align : std::uint8_t { kLeft, kMiddle, kRight };

/// Draws a line of text in DejaVu Sans and the source's colour, its baseline through y and its left
/// end, middle or right end at x: `size` high, or smaller where it would be wider than `room` (all
/// in the surface's units).
void draw_text(cairo_t* cairo, const std::string& text, double x, double y, double size,
               Align align, double room, bool bold = false);

/// Width of such a line, in the surface's units, however little room it has.
double width_of(cairo_t* cairo, const std::string& text, double size, bool bold = false);

/// What is written and drawn over a picture, px from its top left.
class Overlay {
 public:
  Overlay(int width, int height);

  cairo_t* cairo() const { return context_.get(); }
  /// Puts it over a picture of that size: RGB, or RGBA of straight alpha. Throws Error if there was
  /// no room for what was drawn.
  void put_over(Image& picture) const;

 private:
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context_;
};

/// What draw(cairo) writes and draws, put over an image at once. Throws Error as Overlay does.
void write_over(Image& picture, const std::function<void(cairo_t*)>& draw);

}  // namespace clipgs
