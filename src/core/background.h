#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/geometry.h"
#include "core/image.h"

namespace clipgs {

/// What lies behind a picture, display sRGB in [0, 1]: one colour, or two with an even gradient
/// from the upper edge to the lower.
struct Background {
  Vec3 top{0};
  Vec3 bottom{0};

  bool operator==(const Background&) const = default;
};

/// Names of the backgrounds that have one: black, white, studio (dark) and paper (bright). The
/// twins of kBackdrops in web/src/model/backdrop.ts.
std::vector<std::string_view> background_names();
std::optional<Background> find_background(std::string_view name);

/// Straight-alpha RGBA over a background, as RGB: a row has the colour of its middle. A picture of
/// 3 channels is copied.
Image composite(const Image& rgba, const Background& background);

}  // namespace clipgs
