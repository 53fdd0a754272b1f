#pragma once

#include <filesystem>
#include <optional>

#include "core/background.h"

namespace clipgs {

/// `clipgs render --tour`.
struct TourFilmArguments {
  std::filesystem::path tour;
  std::filesystem::path scene;  ///< the case that is shown where a stop does not name another
  std::filesystem::path output;
  int width = 512;
  int height = 512;
  float fps = 16;
  std::optional<Background> background;  ///< where a stop says nothing else
  bool captions = true;
};

/// Draws a tour as the viewer flies it, from its first stop on, and writes it (make_film). Throws
/// Error, before anything is drawn, where a case that it shows is not there or of another volume.
void write_tour_film(const TourFilmArguments& arguments);

}  // namespace clipgs
