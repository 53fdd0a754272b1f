#include "core/draw_text.h"

#include "core/error.h"

namespace clipgs {

double width_of(cairo_t* cairo, const std::string& text, double size, bool bold) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text.c_str(), &extents);
  return extents.x_advance;
}

void draw_text(cairo_t* cairo, const std::string& text, double x, double y, double size,
               Align align, double room, bool bold) {
  const double whole = width_of(cairo, text, size, bold);
  const double shrink = whole > room ? room / whole : 1;
  cairo_set_font_size(cairo, size * shrink);
  const double width = whole * shrink;
  cairo_move_to(cairo,
                align == Align::kLeft     ? x
                : align == Align::kMiddle ? x - width / 2
                                          : x - width,
                y);
  cairo_show_text(cairo, text.c_str());
}

Overlay::Overlay(int width, int height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height),
               cairo_surface_destroy),
      context_(cairo_create(surface_.get()), cairo_destroy) {}

void Overlay::put_over(Image& picture) const {
  cairo_surface_t* const surface = surface_.get();
  cairo_surface_flush(surface);
  const cairo_status_t status = cairo_surface_status(surface);
  if (status != CAIRO_STATUS_SUCCESS) {
    throw Error("the picture's text cannot be drawn: {}; choose a smaller --size",
                cairo_status_to_string(status));
  }
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

void write_over(Image& picture, const std::function<void(cairo_t*)>& draw) {
  const Overlay overlay(picture.width, picture.height);
  draw(overlay.cairo());
  overlay.put_over(picture);
}

}  // namespace clipgs
