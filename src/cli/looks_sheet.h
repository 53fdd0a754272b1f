#pragma once

#include <string>
#include <vector>

#include "core/image.h"
#include "volume/preset.h"

namespace clipgs {

/// A preset's pictures of a volume: RGB (display sRGB), squares of one size.
struct Look {
  Preset preset;
  bool automatic = false;  ///< the preset is the automatic choice
  Image uncut;
  Image cut;
};

/// sRGB behind the pictures.
inline constexpr float kTileBackground[] = {0.10f, 0.11f, 0.14f};

/// Lays the looks, at least one, out in rows under a heading, each as a tile: its pictures side by
/// side, its name and title below. RGB. The words "not for diagnosis" are on it. Throws Error.
Image draw_looks_sheet(const std::vector<Look>& looks, const std::string& heading);

}  // namespace clipgs
