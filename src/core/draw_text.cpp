#include "core/draw_text.h"

#include <memory>

#include "core/error.h"

namespace clipgs {

namespace {

constexpr size_t kBytes = 4;  // a pixel of cairo's surfaces: blue, green, red and alpha

using Cairo = std::unique_ptr<cairo_t, void (*)(cairo_t*)>;
using CairoSurface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;

}  // namespace

void draw_text(cairo_t* cairo, const std::string& text, double x, double y, double size,
               Align align, double room, bool bold) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text.c_str(), &extents);
  const double shrink = extents.x_advance > room ? room / extents.x_advance : 1;
  cairo_set_font_size(cairo, size * shrink);
  const double width = extents.x_advance * shrink;
  cairo_move_to(cairo,
                align == Align::kLeft     ? x
                : align == Align::kMiddle ? x - width / 2
                                          : x - width,
                y);
  cairo_show_text(cairo, text.c_str());
}

void write_over(Image& picture, const std::function<void(cairo_t*)>& draw) {
  const CairoSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, picture.width, picture.height),
      cairo_surface_destroy);
  draw(Cairo(cairo_create(surface.get()), cairo_destroy).get());
  cairo_surface_flush(surface.get());
  const cairo_status_t status = cairo_surface_status(surface.get());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw Error("the picture's text cannot be drawn: {}; choose a smaller --size",
                cairo_status_to_string(status));
  }
  const std::uint8_t* const text = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t* const ink = text + static_cast<size_t>(y) * stride + kBytes * x;
      for (int c = 0; c < 3; ++c) {
        float& value = picture.at(x, y)[c];
        value = static_cast<float>(ink[2 - c]) / 255 +
                value * (1 - static_cast<float>(ink[3]) / 255);  // premultiplied by alpha
      }
    }
  }
}

}  // namespace clipgs
