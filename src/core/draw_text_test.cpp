#include "core/draw_text.h"

#include <algorithm>
#include <cairo.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <string>

#include "core/error.h"

/// Asked by the leak sanitizer: fontconfig keeps what it read of fonts until the process ends.
extern "C" const char* __lsan_default_suppressions() { return "leak:libfontconfig"; }

namespace clipgs {
namespace {

constexpr int kWidth = 300;
constexpr int kHeight = 40;

/// Columns that have ink, from the first to the last; `count` pixels have some.
struct Ink {
  int first = kWidth;
  int last = -1;
  int count = 0;
};

Ink ink_of(const std::string& text, double x, Align align, double room, bool bold = false) {
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_A8, kWidth, kHeight), cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(cairo_create(surface.get()),
                                                           cairo_destroy);
  draw_text(cairo.get(), text, x, 28, 20, align, room, bold);
  cairo_surface_flush(surface.get());
  const unsigned char* const alpha = cairo_image_surface_get_data(surface.get());
  Ink ink;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    if (alpha[i / kWidth * cairo_image_surface_get_stride(surface.get()) + i % kWidth] > 64) {
      ink.first = std::min(ink.first, i % kWidth);
      ink.last = std::max(ink.last, i % kWidth);
      ++ink.count;
    }
  }
  return ink;
}

TEST(DrawText, StandsWhereItIsAligned) {
  const Ink left = ink_of("HHHH", 150, Align::kLeft, 150);
  const Ink middle = ink_of("HHHH", 150, Align::kMiddle, 150);
  const Ink right = ink_of("HHHH", 150, Align::kRight, 150);
  EXPECT_NEAR(left.first, 151, 3);
  EXPECT_NEAR((middle.first + middle.last) / 2.0, 150, 3);
  EXPECT_NEAR(right.last, 148, 3);
  EXPECT_GT(ink_of("HHHH", 150, Align::kLeft, 150, true).count, left.count);
}

TEST(DrawText, ShrinksToItsRoom) {
  const Ink free = ink_of("HHHHHHHH", 10, Align::kLeft, 280);
  const Ink tight = ink_of("HHHHHHHH", 10, Align::kLeft, 60);
  EXPECT_GT(free.last - free.first, 90);
  EXPECT_LE(tight.last, 74);  // hinted letters are whole pixels wide
  EXPECT_GT(tight.last, 60);
}

void half_cover(cairo_t* cairo) {
  cairo_set_source_rgba(cairo, 1, 0.2, 0, 0.6);
  cairo_paint(cairo);
}

TEST(WriteOver, LiesBeforeWhatIsThere) {
  Image rgb(2, 2, 3);
  std::ranges::fill(rgb.data, 0.5f);
  write_over(rgb, half_cover);
  EXPECT_NEAR(rgb.at(1, 1)[0], 0.8, 0.01);
  EXPECT_NEAR(rgb.at(1, 1)[1], 0.32, 0.01);
  EXPECT_NEAR(rgb.at(1, 1)[2], 0.2, 0.01);

  Image rgba(2, 2, 4);  // nothing, then half of white
  std::fill_n(rgba.at(1, 0), 3, 1.0f);
  rgba.at(1, 0)[3] = 0.5f;
  write_over(rgba, half_cover);
  EXPECT_NEAR(rgba.at(0, 0)[0], 1, 0.01);
  EXPECT_NEAR(rgba.at(0, 0)[1], 0.2, 0.01);
  EXPECT_NEAR(rgba.at(0, 0)[3], 0.6, 0.01);
  EXPECT_NEAR(rgba.at(1, 0)[3], 0.8, 0.01);
  EXPECT_NEAR(rgba.at(1, 0)[1], (0.6 * 0.2 + 0.4 * 0.5) / 0.8, 0.01);
}

TEST(WriteOver, TooLargeAPictureIsRefused) {
  Image picture(40'000, 1, 3);
  EXPECT_THAT([&] { write_over(picture, half_cover); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("choose a smaller --size")));
}

}  // namespace
}  // namespace clipgs
