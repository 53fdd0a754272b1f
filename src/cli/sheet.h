#pragma once

#include <cairo.h>
#include <filesystem>

#include "core/image.h"

namespace clipgs {

/// Fills a rectangle of an RGB image with display sRGB.
void fill(Image& sheet, const float (&color)[3], int left, int top, int width, int height);

/// Ink of a lightness, 0…1.
void grey(cairo_t* cairo, double value);

/// Writes a sheet as the path's ending says, .png or else WebP. Throws Error.
void write_sheet(const std::filesystem::path& path, const Image& sheet);

}  // namespace clipgs
