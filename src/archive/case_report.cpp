#include "archive/case_report.h"

#include <algorithm>
#include <cairo-pdf.h>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <memory>

#include "core/draw_text.h"
#include "core/error.h"
#include "core/version.h"

namespace clipgs {

namespace {

using ReportCairo = std::unique_ptr<cairo_t, void (*)(cairo_t*)>;
using ReportSurface = std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)>;

// Points: 1/72 inch.
constexpr double kPageWidth = 595;
constexpr double kPageHeight = 842;
constexpr double kMargin = 56;
constexpr double kTextWidth = kPageWidth - 2 * kMargin;
constexpr double kLine = 16;
constexpr double kTextSize = 10;

void ink(cairo_t* cairo, double grey) { cairo_set_source_rgb(cairo, grey, grey, grey); }

/// Writes a line and goes to the next.
void write_line(cairo_t* cairo, double& y, const std::string& text, double size = kTextSize,
                bool bold = false) {
  draw_text(cairo, text, kMargin, y, size, Align::kLeft, kTextWidth, bold);
  y += std::max(kLine, 1.5 * size);
}

/// A picture `size` points wide.
void draw_picture(cairo_t* cairo, const Image& picture, double x, double y, double size) {
  const ReportSurface surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, picture.width, picture.height),
      cairo_surface_destroy);
  const int stride = cairo_image_surface_get_stride(surface.get());
  unsigned char* const bytes = cairo_image_surface_get_data(surface.get());
  if (bytes == nullptr) {
    throw Error("a picture of the report cannot be drawn: {}",
                cairo_status_to_string(cairo_surface_status(surface.get())));
  }
  for (int row = 0; row < picture.height; ++row) {
    auto* const texels =
        reinterpret_cast<std::uint32_t*>(bytes + static_cast<size_t>(row) * stride);
    for (int column = 0; column < picture.width; ++column) {
      texels[column] = 0;
      for (int c = 0; c < 3; ++c) {
        const float value = std::clamp(picture.at(column, row)[c], 0.0f, 1.0f);
        texels[column] =
            texels[column] << 8U | static_cast<std::uint32_t>(std::lround(255 * value));
      }
    }
  }
  cairo_surface_mark_dirty(surface.get());
  cairo_save(cairo);
  cairo_translate(cairo, x, y);
  cairo_scale(cairo, size / picture.width, size / picture.width);
  cairo_set_source_surface(cairo, surface.get(), 0, 0);
  cairo_paint(cairo);
  cairo_restore(cairo);
}

void write_pictures(cairo_t* cairo, double& y, const std::vector<Image>& pictures) {
  constexpr double kGap = 6;
  if (pictures.empty()) {
    return;
  }
  const auto count = static_cast<double>(std::max<size_t>(pictures.size(), 3));
  const double size = (kTextWidth - (count - 1) * kGap) / count;
  double x = kMargin;
  for (const Image& picture : pictures) {
    draw_picture(cairo, picture, x, y, size);
    x += size + kGap;
  }
  y += size + 2 * kLine;
}

void write_link(cairo_t* cairo, double& y, const std::string& link) {
  std::string quoted;  // PDF's strings, as cairo reads them
  for (const char c : link) {
    quoted += c == '\'' || c == '\\' ? std::string{'\\', c} : std::string{c};
  }
  write_line(cairo, y, "Cut it open in a browser:");
  cairo_tag_begin(cairo, CAIRO_TAG_LINK, fmt::format("uri='{}'", quoted).c_str());
  cairo_set_source_rgb(cairo, 0, 0.2, 0.7);
  write_line(cairo, y, link);
  cairo_tag_end(cairo, CAIRO_TAG_LINK);
  ink(cairo, 0);
  y += kLine;
}

void write_notes(cairo_t* cairo, double& y, const std::vector<std::string>& notes) {
  constexpr size_t kMost = 12;
  write_line(cairo, y,
             notes.empty() ? "The build had no warnings." : "Warnings of the build:", kTextSize,
             !notes.empty());
  for (size_t i = 0; i < std::min(notes.size(), kMost); ++i) {
    write_line(cairo, y, notes[i]);
  }
  if (notes.size() > kMost) {
    write_line(cairo, y, fmt::format("and {} more", notes.size() - kMost));
  }
}

void write_page(cairo_t* cairo, const CaseReport& report) {
  double y = kMargin + kLine;
  write_line(cairo, y, report.title, 20, true);
  write_line(cairo, y,
             "Not for diagnosis. A 3D scene made by a program for looking, teaching and talks; "
             "read the images themselves.");
  y += kLine / 2;
  write_pictures(cairo, y, report.pictures);
  if (!report.link.empty()) {
    write_link(cairo, y, report.link);
  }
  for (const auto& [what, value] : report.figures) {
    draw_text(cairo, what, kMargin, y, kTextSize, Align::kLeft, 0.3 * kTextWidth);
    draw_text(cairo, value, kMargin + 0.3 * kTextWidth, y, kTextSize, Align::kLeft,
              0.7 * kTextWidth);
    y += kLine;
  }
  y += kLine;
  write_notes(cairo, y, report.notes);
  ink(cairo, 0.4);
  draw_text(cairo,
            fmt::format("clipgs {}: no medical device, not for diagnosis", program_version()),
            kMargin, kPageHeight - kMargin, 8, Align::kLeft, kTextWidth);
}

cairo_status_t append(void* closure, const unsigned char* bytes, unsigned size) {
  static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(bytes), size);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

std::string report_pdf(const CaseReport& report) {
  std::string pdf;
  const ReportSurface surface(
      cairo_pdf_surface_create_for_stream(append, &pdf, kPageWidth, kPageHeight),
      cairo_surface_destroy);
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, report.title.c_str());
  // Else the time of the day: the same input would give other bytes.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE,
                                 "2000-01-01T00:00:00Z");
  const ReportCairo cairo(cairo_create(surface.get()), cairo_destroy);
  write_page(cairo.get(), report);
  cairo_surface_finish(surface.get());
  const cairo_status_t status = cairo_surface_status(surface.get());
  if (cairo_status(cairo.get()) != CAIRO_STATUS_SUCCESS || status != CAIRO_STATUS_SUCCESS) {
    throw Error("the report cannot be drawn: {}", cairo_status_to_string(status));
  }
  return pdf;
}

}  // namespace clipgs
