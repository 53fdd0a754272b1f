#include "core/draw_text.h"

namespace clipgs {

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

}  // namespace clipgs
