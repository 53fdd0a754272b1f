#include "cli/histogram_picture.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "cli/sheet.h"
#include "core/draw_text.h"

namespace clipgs {
namespace {

// Lengths in px.
constexpr int kLeft = 88;
constexpr int kTop = 52;
constexpr int kRight = 28;
constexpr int kBottom = 62;  // ticks and the name of the axis
constexpr int kStrip = 16;   // the preset's colours
constexpr int kStripGap = 6;
constexpr int kPlotWidth = SteepnessHistogram::kColumns;
constexpr int kPlotHeight = SteepnessHistogram::kRows;
constexpr double kTextSize = 13;
constexpr double kBright = 0.93;
constexpr double kDim = 0.66;
constexpr float kPaper[] = {0.05f, 0.055f, 0.07f};
constexpr float kEmpty[] = {0.10f, 0.11f, 0.14f};
const Vec3 kFull(1.0f, 0.93f, 0.72f);

/// From round number to round number, about `wanted` of them over `range`.
float tick_step(float range, float wanted) {
  const float rough = range / wanted;
  const float decade = std::pow(10.0f, std::floor(std::log10(rough)));
  for (const float factor : {1.0f, 2.0f, 5.0f}) {
    if (factor * decade >= rough) {
      return factor * decade;
    }
  }
  return 10 * decade;
}

/// Calls use(value) for the round numbers from `low` to `high`.
template <typename Use>
void for_ticks(float low, float high, float wanted, const Use& use) {
  const float step = tick_step(high - low, wanted);
  const auto first = static_cast<int>(std::ceil(low / step));
  const auto last = static_cast<int>(std::floor(high / step));
  for (int i = first; i <= last; ++i) {
    use(static_cast<float>(i) * step);
  }
}

class HistogramSheet {
 public:
  HistogramSheet(const SteepnessHistogram& histogram, const Preset& preset, const std::string& unit)
      : histogram_(histogram),
        preset_(preset),
        unit_(unit),
        strips_(preset.boundary ? 2 : 1),
        sheet_(kLeft + kPlotWidth + kRight,
               kTop + kPlotHeight + strips_ * (kStripGap + kStrip) + kBottom, 3) {
    fill(sheet_, kPaper, 0, 0, sheet_.width, sheet_.height);
  }

  Image draw() {
    draw_counts();
    draw_strip(0, [&](float value) { return preset_.transfer.at(value); });
    if (preset_.boundary) {
      draw_strip(1, [&](float value) {
        return preset_.boundary->mixed(preset_.transfer.at(value), value, 1);
      });
    }
    write_over(sheet_, [&](cairo_t* cairo) { write(cairo); });
    return std::move(sheet_);
  }

 private:
  static int strip_top(int strip) {
    return kTop + kPlotHeight + kStripGap + strip * (kStrip + kStripGap);
  }
  float value_at(int column) const {
    return histogram_.low +
           (histogram_.high - histogram_.low) * (static_cast<float>(column) + 0.5f) / kPlotWidth;
  }
  double x_of(float value) const {
    const float part = (value - histogram_.low) / (histogram_.high - histogram_.low);
    return kLeft + double{kPlotWidth} * static_cast<double>(part);
  }
  double y_of(float steepness) const {
    return kTop + kPlotHeight * (1 - static_cast<double>(steepness / histogram_.steepest));
  }

  void draw_counts() {
    std::uint64_t most = 1;
    for (const auto& row : *histogram_.counts) {
      most = std::max(most, std::ranges::max(row));
    }
    const auto full = static_cast<float>(std::log1p(static_cast<double>(most)));
    const Vec3 empty(kEmpty[0], kEmpty[1], kEmpty[2]);
    for (int row = 0; row < kPlotHeight; ++row) {
      for (int column = 0; column < kPlotWidth; ++column) {
        const auto count = static_cast<double>(
            (*histogram_.counts)[static_cast<size_t>(row)][static_cast<size_t>(column)]);
        const Vec3 color = glm::mix(empty, kFull, static_cast<float>(std::log1p(count)) / full);
        std::copy_n(&color[0], 3, sheet_.at(kLeft + column, kTop + kPlotHeight - 1 - row));
      }
    }
  }

  template <typename Materials>
  void draw_strip(int strip, const Materials& material_of) {
    const Vec3 empty(kEmpty[0], kEmpty[1], kEmpty[2]);
    for (int column = 0; column < kPlotWidth; ++column) {
      const Material m = material_of(value_at(column));
      const Vec3 albedo(srgb_from_linear(m.albedo.r), srgb_from_linear(m.albedo.g),
                        srgb_from_linear(m.albedo.b));
      const Vec3 color = glm::mix(empty, albedo, 1 - std::exp(-m.extinction));
      for (int y = 0; y < kStrip; ++y) {
        std::copy_n(&color[0], 3, sheet_.at(kLeft + column, strip_top(strip) + y));
      }
    }
  }

  void write(cairo_t* cairo) const {
    grey(cairo, kBright);
    draw_text(cairo, fmt::format("Value and gradient, with preset {}", preset_.name), kLeft, 31, 18,
              Align::kLeft, 0.7 * kPlotWidth, true);
    grey(cairo, kDim);
    draw_text(cairo, "logarithm of the number of voxels", kLeft + kPlotWidth, 31, kTextSize,
              Align::kRight, 0.29 * kPlotWidth);
    const int bottom = strip_top(strips_);
    cairo_set_line_width(cairo, 1);
    for_ticks(histogram_.low, histogram_.high, 9, [&](float value) {
      line(cairo, x_of(value), bottom - kStripGap, x_of(value), bottom);
      draw_text(cairo, fmt::format("{:g}", value), x_of(value), bottom + 14, kTextSize,
                Align::kMiddle, kPlotWidth);
    });
    for_ticks(0, histogram_.steepest, 7, [&](float steepness) {
      line(cairo, kLeft - 6, y_of(steepness), kLeft, y_of(steepness));
      draw_text(cairo, fmt::format("{:g}", steepness), kLeft - 10, y_of(steepness) + 4.5, kTextSize,
                Align::kRight, kLeft - 30);
    });
    const std::string value = unit_.empty() ? "value" : fmt::format("value, {}", unit_);
    draw_text(cairo, value, kLeft + 0.5 * kPlotWidth, sheet_.height - 14, kTextSize + 1,
              Align::kMiddle, kPlotWidth);
    cairo_save(cairo);
    cairo_translate(cairo, 20, kTop + 0.5 * kPlotHeight);
    cairo_rotate(cairo, -0.5 * std::numbers::pi);
    draw_text(
        cairo,
        unit_.empty() ? "gradient, value units per mm" : fmt::format("gradient, {} per mm", unit_),
        0, 0, kTextSize + 1, Align::kMiddle, kPlotHeight);
    cairo_restore(cairo);
    write_strip(cairo, 0, "even");
    if (preset_.boundary) {
      write_strip(cairo, 1, "steep");
      mark(cairo, preset_.boundary->range.from, "boundary from");
      mark(cairo, preset_.boundary->range.to, "boundary to");
    }
  }
  static void line(cairo_t* cairo, double x0, double y0, double x1, double y1) {
    cairo_move_to(cairo, x0, y0);
    cairo_line_to(cairo, x1, y1);
    cairo_stroke(cairo);
  }
  static void write_strip(cairo_t* cairo, int strip, const std::string& name) {
    draw_text(cairo, name, kLeft - 10, strip_top(strip) + kStrip - 3.5, kTextSize, Align::kRight,
              kLeft - 20);
  }
  /// Across the plot, if it is not above.
  void mark(cairo_t* cairo, float steepness, const std::string& name) const {
    if (steepness > histogram_.steepest) {
      return;
    }
    const double y = y_of(steepness);
    line(cairo, kLeft, y, kLeft + kPlotWidth, y);
    draw_text(cairo, fmt::format("{} {:g}", name, steepness), kLeft + kPlotWidth - 6, y - 5,
              kTextSize, Align::kRight, kPlotWidth);
  }

  const SteepnessHistogram& histogram_;
  const Preset& preset_;
  const std::string& unit_;
  int strips_;
  Image sheet_;
};

}  // namespace

Vec2 histogram_values(const Preset& preset) {
  const float low = preset.transfer.min_value();
  const float high = preset.transfer.max_value();
  const float more = 0.25f * (high - low);
  return {low - more, high + more};
}

Image draw_histogram(const SteepnessHistogram& histogram, const Preset& preset,
                     const std::string& unit) {
  return HistogramSheet(histogram, preset, unit).draw();
}

}  // namespace clipgs
