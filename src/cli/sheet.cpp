#include "cli/sheet.h"

#include <algorithm>
#include <cstdint>
#include <memory>

#include "asset/webp.h"
#include "core/error.h"
#include "core/file.h"

namespace clipgs {
namespace {

constexpr size_t kBytes = 4;  // a pixel of cairo's surfaces: blue, green, red and alpha

using Cairo = std::unique_ptr<cairo_t, void (*)(cairo_t*)>;
using CairoSurface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;

}  // namespace

void fill(Image& sheet, const float (&color)[3], int left, int top, int width, int height) {
  for (int y = top; y < top + height; ++y) {
    for (int x = left; x < left + width; ++x) {
      std::ranges::copy(color, sheet.at(x, y));
    }
  }
}

void write_over(Image& sheet, const std::function<void(cairo_t*)>& draw) {
  const CairoSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, sheet.width, sheet.height),
      cairo_surface_destroy);
  draw(Cairo(cairo_create(surface.get()), cairo_destroy).get());
  cairo_surface_flush(surface.get());
  const cairo_status_t status = cairo_surface_status(surface.get());
  if (status != CAIRO_STATUS_SUCCESS) {
    throw Error("the sheet's text cannot be drawn: {}; choose a smaller --size",
                cairo_status_to_string(status));
  }
  const std::uint8_t* const text = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < sheet.height; ++y) {
    for (int x = 0; x < sheet.width; ++x) {
      const std::uint8_t* const ink = text + static_cast<size_t>(y) * stride + kBytes * x;
      for (int c = 0; c < 3; ++c) {
        float& value = sheet.at(x, y)[c];
        value = static_cast<float>(ink[2 - c]) / 255 +
                value * (1 - static_cast<float>(ink[3]) / 255);  // premultiplied by alpha
      }
    }
  }
}

void grey(cairo_t* cairo, double value) { cairo_set_source_rgb(cairo, value, value, value); }

void write_sheet(const std::filesystem::path& path, const Image& sheet) {
  if (path.extension() == ".png") {
    write_png(path, sheet);
    return;
  }
  constexpr float kQuality = 90;  // text stays sharp
  const Bytes bytes = encode_webp(sheet, kQuality);
  write_file(path, bytes.data(), bytes.size());
}

}  // namespace clipgs
