#include "study/study_plot.h"

#include <algorithm>
#include <array>
#include <cairo-svg.h>
#include <cairo.h>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "core/draw_text.h"
#include "core/error.h"
#include "core/file.h"
#include "study/study_report.h"

namespace clipgs {

namespace {

// Lengths are in units of the page, two pixels of a PNG.
constexpr double kPanelWidth = 280;
constexpr double kPanelHeight = 340;
constexpr double kMargin = 20;
constexpr double kHead = 46;   // the page's title and what the signs mean
constexpr double kPixels = 2;  // of a PNG, a unit
constexpr size_t kMostColumns = 4;

struct Color {
  double red, green, blue;
};
// Of Okabe & Ito's palette, which the colour-blind tell apart as well.
constexpr Color kFirst{0.0, 0.447, 0.698};
constexpr Color kSecond{0.835, 0.369, 0.0};
constexpr Color kInk{0.13, 0.14, 0.16};
constexpr Color kQuiet{0.40, 0.42, 0.45};
constexpr Color kGrid{0.90, 0.91, 0.92};
constexpr Color kLine{0.62, 0.64, 0.67};

/// Draws on one cairo surface.
class Pen {
 public:
  explicit Pen(cairo_surface_t* surface) : cairo_(cairo_create(surface), cairo_destroy) {}

  cairo_t* get() const { return cairo_.get(); }
  void color(const Color& c, double alpha = 1) const {
    cairo_set_source_rgba(get(), c.red, c.green, c.blue, alpha);
  }
  void line(double x0, double y0, double x1, double y1, double width) const {
    cairo_set_line_width(get(), width);
    cairo_move_to(get(), x0, y0);
    cairo_line_to(get(), x1, y1);
    cairo_stroke(get());
  }
  void dot(double x, double y, double radius) const {
    cairo_arc(get(), x, y, radius, 0, 2 * std::numbers::pi);
    cairo_fill(get());
  }
  void text(const std::string& text, double x, double y, double size, Align align, double room,
            bool bold = false) const {
    draw_text(get(), text, x, y, size, align, room, bold);
  }

 private:
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo_;
};

/// Values up the side of a panel, at round numbers.
struct ValueAxis {
  double low = 0;
  double high = 1;
  double step = 1;
  int decimals = 0;
};

ValueAxis axis_of(const MeasureComparison& measure) {
  double low = std::min(measure.first->min, measure.second->min);
  double high = std::max(measure.first->max, measure.second->max);
  const double spread = high > low ? high - low : std::max(1.0, std::abs(high) / 10);
  low -= high > low ? 0 : spread / 2;
  high = std::max(high, low + spread);
  const double rough = spread / 5;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0}) {
    step = factor * power >= rough ? factor * power : step;
  }
  ValueAxis axis;
  axis.step = step;
  axis.low = std::floor(low / step) * step;
  axis.high = std::ceil(high / step) * step;
  axis.decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return axis;
}

/// Where a panel's parts lie.
struct PanelFrame {
  double left, top;  // of the panel
  ValueAxis axis;

  double plot_left() const { return left + 52; }
  double plot_right() const { return left + kPanelWidth - 14; }
  double plot_top() const { return top + 58; }
  double plot_bottom() const { return top + kPanelHeight - 52; }
  double across(double share) const { return plot_left() + share * (plot_right() - plot_left()); }
  double y(double value) const {
    return plot_bottom() -
           (plot_bottom() - plot_top()) * (value - axis.low) / (axis.high - axis.low);
  }
};

constexpr std::array kDotsAt{0.36, 0.64};   // shares of the plot's width
constexpr std::array kBoxesAt{0.15, 0.85};  // outside of the dots, so that lines cross no box
constexpr std::array kModeColors{kFirst, kSecond};

double value_of(const MeasurePair& pair, size_t mode) {
  return mode == 0 ? pair.first : pair.second;
}

/// Where dots stand: those that would hide each other side by side, in the order of what their
/// lines lead to, so that these cross less.
std::vector<double> dots_across(const PanelFrame& frame, std::span<const MeasurePair> pairs,
                                size_t mode) {
  constexpr double kApart = 7;
  constexpr double kRoom = 42;
  constexpr double kNear = 6;
  std::vector<size_t> order(pairs.size());
  for (size_t i = 0; i < order.size(); ++i) {
    order[i] = i;
  }
  std::ranges::stable_sort(order, {}, [&](size_t i) { return value_of(pairs[i], mode); });
  std::vector<double> x(pairs.size());
  for (size_t begin = 0; begin < order.size();) {
    size_t end = begin + 1;
    const double bottom = frame.y(value_of(pairs[order[begin]], mode));
    while (end < order.size() && bottom - frame.y(value_of(pairs[order[end]], mode)) < kNear) {
      ++end;
    }
    std::stable_sort(order.begin() + begin, order.begin() + end, [&](size_t a, size_t b) {
      return value_of(pairs[a], 1 - mode) < value_of(pairs[b], 1 - mode);
    });
    const auto count = static_cast<double>(end - begin);
    const double apart = count > 1 ? std::min(kApart, kRoom / (count - 1)) : 0;
    for (size_t i = begin; i < end; ++i) {
      x[order[i]] =
          frame.across(kDotsAt[mode]) + (static_cast<double>(i - begin) - (count - 1) / 2) * apart;
    }
    begin = end;
  }
  return x;
}

void draw_axis(const Pen& pen, const PanelFrame& frame) {
  const ValueAxis& axis = frame.axis;
  const auto ticks = static_cast<int>(std::lround((axis.high - axis.low) / axis.step));
  for (int i = 0; i <= ticks; ++i) {
    const double value = axis.low + i * axis.step;
    pen.color(kGrid);
    pen.line(frame.plot_left(), frame.y(value), frame.plot_right(), frame.y(value), 1);
    pen.color(kQuiet);
    pen.text(signed_text(value, axis.decimals), frame.plot_left() - 8, frame.y(value) + 4, 11,
             Align::kRight, 40);
  }
}

void draw_pairs(const Pen& pen, const PanelFrame& frame, std::span<const MeasurePair> pairs) {
  const std::array x{dots_across(frame, pairs, 0), dots_across(frame, pairs, 1)};
  pen.color(kLine, pairs.size() > 40 ? 0.4 : 0.9);
  for (size_t i = 0; i < pairs.size(); ++i) {
    pen.line(x[0][i], frame.y(pairs[i].first), x[1][i], frame.y(pairs[i].second), 1.1);
  }
  for (size_t mode = 0; mode < 2; ++mode) {
    for (size_t i = 0; i < pairs.size(); ++i) {
      const double y = frame.y(value_of(pairs[i], mode));
      pen.color({1, 1, 1});
      pen.dot(x[mode][i], y, 4.2);
      pen.color(kModeColors[mode]);
      pen.dot(x[mode][i], y, 3.3);
    }
  }
}

/// The outermost values within 1.5 times the quartiles' distance from them.
Interval whiskers(const Descriptives& all, std::span<const MeasurePair> pairs, size_t mode) {
  const double reach = 1.5 * all.iqr();
  Interval ends{all.q1, all.q3};
  for (const MeasurePair& pair : pairs) {
    const double value = value_of(pair, mode);
    ends.low = value >= all.q1 - reach ? std::min(ends.low, value) : ends.low;
    ends.high = value <= all.q3 + reach ? std::max(ends.high, value) : ends.high;
  }
  return ends;
}

void draw_box(const Pen& pen, const PanelFrame& frame, const MeasureComparison& measure,
              size_t mode) {
  constexpr double kHalf = 13;
  const Descriptives& all = mode == 0 ? *measure.first : *measure.second;
  const double x = frame.across(kBoxesAt[mode]);
  const Interval ends = whiskers(all, measure.pairs, mode);
  const Color& color = kModeColors[mode];
  pen.color(color);
  pen.line(x, frame.y(ends.low), x, frame.y(all.q1), 1.4);
  pen.line(x, frame.y(ends.high), x, frame.y(all.q3), 1.4);
  for (const double end : {ends.low, ends.high}) {
    pen.line(x - kHalf / 2, frame.y(end), x + kHalf / 2, frame.y(end), 1.4);
  }
  cairo_rectangle(pen.get(), x - kHalf, frame.y(all.q3), 2 * kHalf,
                  frame.y(all.q1) - frame.y(all.q3));
  pen.color(color, 0.16);
  cairo_fill_preserve(pen.get());
  pen.color(color);
  cairo_set_line_width(pen.get(), 1.4);
  cairo_stroke(pen.get());
  pen.line(x - kHalf, frame.y(all.median), x + kHalf, frame.y(all.median), 2.8);
  constexpr double kDiamond = 5;
  const double y = frame.y(all.mean);
  cairo_move_to(pen.get(), x, y - kDiamond);
  cairo_line_to(pen.get(), x + kDiamond, y);
  cairo_line_to(pen.get(), x, y + kDiamond);
  cairo_line_to(pen.get(), x - kDiamond, y);
  cairo_close_path(pen.get());
  pen.color({1, 1, 1});
  cairo_fill_preserve(pen.get());
  pen.color(color);
  cairo_set_line_width(pen.get(), 1.4);
  cairo_stroke(pen.get());
}

/// The suggested test in one line.
std::string finding(const MeasureComparison& measure) {
  if (measure.suggested == PairedTest::kT) {
    return fmt::format("t({:.0f}) = {}, {}", measure.t->df, signed_text(measure.t->t, 2),
                       p_text(measure.t->p));
  }
  if (measure.suggested == PairedTest::kWilcoxon) {
    const Wilcoxon& test = *measure.wilcoxon;
    return test.exact_p
               ? fmt::format("Wilcoxon W = {:g}, exact {}", test.w, p_text(*test.exact_p))
               : fmt::format("Wilcoxon Z = {}, {}", signed_text(test.z, 2), p_text(test.p));
  }
  return measure.note;
}

void draw_panel(const Pen& pen, const StudyComparison& comparison, const MeasureComparison& measure,
                double left, double top) {
  const PanelFrame frame{left, top, axis_of(measure)};
  const MeasureTitle title = measure_title(measure.measure);
  pen.color(kInk);
  pen.text(title.title, frame.plot_left(), top + 20, 15, Align::kLeft, kPanelWidth - 70, true);
  pen.color(kQuiet);
  const std::string unit = title.unit.empty() ? "" : title.unit + " · ";
  pen.text(fmt::format("{}n = {} · {}", unit, measure.pairs.size(), finding(measure)),
           frame.plot_left(), top + 38, 11, Align::kLeft, kPanelWidth - 66);
  draw_axis(pen, frame);
  draw_pairs(pen, frame, measure.pairs);
  for (size_t mode = 0; mode < 2; ++mode) {
    draw_box(pen, frame, measure, mode);
    pen.color(kModeColors[mode]);
    pen.text(comparison.modes[mode], frame.across(mode == 0 ? 0.25 : 0.75),
             frame.plot_bottom() + 22, 13, Align::kMiddle,
             (frame.plot_right() - frame.plot_left()) / 2 - 6, true);
    const Descriptives& all = mode == 0 ? *measure.first : *measure.second;
    pen.color(kQuiet);
    pen.text(all.sd ? fmt::format("{} ± {}", signed_text(all.mean, 2), signed_text(*all.sd, 2))
                    : signed_text(all.mean, 2),
             frame.across(mode == 0 ? 0.25 : 0.75), frame.plot_bottom() + 38, 11, Align::kMiddle,
             (frame.plot_right() - frame.plot_left()) / 2 - 6);
  }
}

struct PlotPage {
  std::vector<const MeasureComparison*> panels;
  size_t columns = 1;

  double width() const { return 2 * kMargin + static_cast<double>(columns) * kPanelWidth; }
  double height() const {
    const size_t rows = (panels.size() + columns - 1) / columns;
    return 2 * kMargin + kHead + static_cast<double>(rows) * kPanelHeight;
  }
};

PlotPage lay_out(const StudyComparison& comparison) {
  PlotPage page;
  for (const MeasureComparison& measure : comparison.measures) {
    if (!measure.pairs.empty()) {
      page.panels.push_back(&measure);
    }
  }
  // As square as may be, and no column emptier than it must be.
  const size_t rows = (page.panels.size() + kMostColumns - 1) / kMostColumns;
  page.columns = rows > 0 ? (page.panels.size() + rows - 1) / rows : 1;
  return page;
}

void draw_page(cairo_surface_t* surface, const StudyComparison& comparison, const PlotPage& page) {
  const Pen pen(surface);
  pen.color({1, 1, 1});
  cairo_paint(pen.get());
  const double room = page.width() - 2 * kMargin;
  pen.color(kInk);
  pen.text(fmt::format("{} against {}", comparison.modes[0], comparison.modes[1]), kMargin + 8,
           kMargin + 14, 17, Align::kLeft, room - 16, true);
  pen.color(kQuiet);
  pen.text("a line joins a participant's values · box: quartiles, median · ◇ mean · ± SD",
           kMargin + 8, kMargin + 34, 11, Align::kLeft, room - 16);
  for (size_t i = 0; i < page.panels.size(); ++i) {
    const size_t column = i % page.columns;
    const size_t row = i / page.columns;
    draw_panel(pen, comparison, *page.panels[i],
               kMargin + static_cast<double>(column) * kPanelWidth,
               kMargin + kHead + static_cast<double>(row) * kPanelHeight);
  }
}

cairo_status_t collect(void* bytes, const unsigned char* data, unsigned int size) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

void require_success(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw Error("the plot cannot be drawn: {}; compare fewer measures",
                cairo_status_to_string(status));
  }
}

using Surface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;

std::string draw_svg(const StudyComparison& comparison, const PlotPage& page) {
  std::string bytes;
  const Surface surface(
      cairo_svg_surface_create_for_stream(collect, &bytes, page.width(), page.height()),
      cairo_surface_destroy);
  draw_page(surface.get(), comparison, page);
  cairo_surface_finish(surface.get());
  require_success(cairo_surface_status(surface.get()));
  return bytes;
}

std::string draw_png(const StudyComparison& comparison, const PlotPage& page) {
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(page.width() * kPixels),
                                 static_cast<int>(page.height() * kPixels)),
      cairo_surface_destroy);
  require_success(cairo_surface_status(surface.get()));
  cairo_surface_set_device_scale(surface.get(), kPixels, kPixels);
  draw_page(surface.get(), comparison, page);
  std::string bytes;
  require_success(cairo_surface_write_to_png_stream(surface.get(), collect, &bytes));
  return bytes;
}

}  // namespace

void write_study_plot(const StudyComparison& comparison, const std::filesystem::path& path) {
  const PlotPage page = lay_out(comparison);
  if (page.panels.empty()) {
    throw Error("{}: there is nothing to draw: no participant has a measure in both modes",
                path.string());
  }
  const bool png = path.extension() == ".png";
  if (!png && path.extension() != ".svg") {
    throw Error("{}: give a name that ends in .svg or .png", path.string());
  }
  const std::string bytes = png ? draw_png(comparison, page) : draw_svg(comparison, page);
  write_file(path, bytes.data(), bytes.size());
}

}  // namespace clipgs
