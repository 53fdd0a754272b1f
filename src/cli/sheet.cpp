#include "cli/sheet.h"

#include <algorithm>

#include "asset/webp.h"
#include "core/file.h"

namespace clipgs {

void fill(Image& sheet, const float (&color)[3], int left, int top, int width, int height) {
  for (int y = top; y < top + height; ++y) {
    for (int x = left; x < left + width; ++x) {
      std::ranges::copy(color, sheet.at(x, y));
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
