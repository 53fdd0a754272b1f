#pragma once

#include <cairo.h>
#include <cstdint>
#include <functional>
#include <string>

#include "core/image.h"

namespace clipgs {

enum class Align : std::uint8_t { kLeft, kMiddle, kRight };

/// Draws a line of text in DejaVu Sans and the source's colour, its baseline through y and its left
/// end, middle or right end at x: `size` high, or smaller where it would be wider than `room` (all
/// in the surface's units).
void draw_text(cairo_t* cairo, const std::string& text, double x, double y, double size,
               Align align, double room, bool bold = false);

/// draw(cairo) writes and draws over an RGB image, in px. Throws Error if the image is too large.
void write_over(Image& picture, const std::function<void(cairo_t*)>& draw);

}  // namespace clipgs
