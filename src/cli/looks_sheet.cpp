#include "cli/looks_sheet.h"

#include <algorithm>
#include <cmath>

#include "cli/sheet.h"
#include "core/draw_text.h"

namespace clipgs {
namespace {

// Lengths in px.
constexpr int kGap = 16;    // between tiles
constexpr int kHead = 48;   // the heading
constexpr int kLabel = 44;  // under a tile: name and title
constexpr float kSheetBackground[] = {0.05f, 0.055f, 0.07f};
constexpr double kInk = 0.93;
constexpr double kQuiet = 0.66;

struct SheetLayout {
  int tile_width, tile_height;
  int columns, rows;

  explicit SheetLayout(const std::vector<Look>& looks)
      : tile_width(2 * looks.front().uncut.width),
        tile_height(looks.front().uncut.height + kLabel) {
    constexpr double kShape = 4.0 / 3;  // of the sheet, about
    const auto count = static_cast<int>(looks.size());
    const double columns_of_shape = std::sqrt(count * kShape * tile_height / tile_width);
    columns = std::clamp(static_cast<int>(std::lround(columns_of_shape)), 1, count);
    rows = (count + columns - 1) / columns;
  }

  int width() const { return kGap + columns * (tile_width + kGap); }
  int height() const { return kHead + rows * (tile_height + kGap); }
  int left(int tile) const { return kGap + tile % columns * (tile_width + kGap); }
  int top(int tile) const { return kHead + tile / columns * (tile_height + kGap); }
};

void put(Image& sheet, const Image& picture, int left, int top) {
  for (int y = 0; y < picture.height; ++y) {
    std::copy_n(picture.at(0, y), 3 * static_cast<size_t>(picture.width), sheet.at(left, top + y));
  }
}

}  // namespace

Image draw_looks_sheet(const std::vector<Look>& looks, const std::string& heading) {
  const SheetLayout layout(looks);
  Image sheet(layout.width(), layout.height(), 3);
  fill(sheet, kSheetBackground, 0, 0, sheet.width, sheet.height);
  for (int i = 0; i < static_cast<int>(looks.size()); ++i) {
    fill(sheet, kTileBackground, layout.left(i), layout.top(i), layout.tile_width,
         layout.tile_height);
    put(sheet, looks[i].uncut, layout.left(i), layout.top(i));
    put(sheet, looks[i].cut, layout.left(i) + looks[i].uncut.width, layout.top(i));
  }
  write_over(sheet, [&](cairo_t* cairo) {
    const double room = layout.width() - 2.0 * kGap;
    grey(cairo, kInk);
    draw_text(cairo, heading, kGap, 31, 18, Align::kLeft, 0.72 * room, true);
    grey(cairo, kQuiet);
    draw_text(cairo, "not for diagnosis", layout.width() - kGap, 31, 14, Align::kRight,
              0.26 * room);
    for (int i = 0; i < static_cast<int>(looks.size()); ++i) {
      const Look& look = looks[i];
      const double middle = layout.left(i) + 0.5 * layout.tile_width;
      const double bottom = layout.top(i) + layout.tile_height;
      grey(cairo, kInk);
      draw_text(cairo, look.preset.name, middle, bottom - 25, 15, Align::kMiddle, layout.tile_width,
                true);
      grey(cairo, kQuiet);
      draw_text(cairo, look.preset.title + (look.automatic ? " · the automatic choice" : ""),
                middle, bottom - 7, 13, Align::kMiddle, layout.tile_width);
    }
  });
  return sheet;
}

}  // namespace clipgs
