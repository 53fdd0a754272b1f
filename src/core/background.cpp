#include "core/background.h"

#include <algorithm>
#include <array>

namespace clipgs {
namespace {

struct NamedBackground {
  std::string_view name;
  Background background;
};

Vec3 of_bytes(int r, int g, int b) { return Vec3(r, g, b) / 255.0f; }

const std::array<NamedBackground, 4>& named_backgrounds() {
  static const std::array<NamedBackground, 4> all = {
      NamedBackground{"black", {Vec3(0), Vec3(0)}}, NamedBackground{"white", {Vec3(1), Vec3(1)}},
      NamedBackground{"studio", {of_bytes(0x2e, 0x36, 0x42), of_bytes(0x0a, 0x0c, 0x10)}},
      NamedBackground{"paper", {of_bytes(0xfb, 0xfa, 0xf7), of_bytes(0xe2, 0xdf, 0xd8)}}};
  return all;
}

}  // namespace

std::vector<std::string_view> background_names() {
  std::vector<std::string_view> names;
  for (const NamedBackground& one : named_backgrounds()) {
    names.push_back(one.name);
  }
  return names;
}

std::optional<Background> find_background(std::string_view name) {
  const auto* const found = std::ranges::find(named_backgrounds(), name, &NamedBackground::name);
  return found == named_backgrounds().end() ? std::nullopt : std::optional(found->background);
}

Image composite(const Image& rgba, const Background& background) {
  if (rgba.channels == 3) {
    return rgba;
  }
  Image out(rgba.width, rgba.height, 3);
  for (int y = 0; y < rgba.height; ++y) {
    const float down = (static_cast<float>(y) + 0.5f) / static_cast<float>(rgba.height);
    const Vec3 behind = background.top + down * (background.bottom - background.top);
    for (int x = 0; x < rgba.width; ++x) {
      const float* in = rgba.at(x, y);
      for (int c = 0; c < 3; ++c) {
        out.at(x, y)[c] = in[c] * in[3] + behind[c] * (1.0f - in[3]);
      }
    }
  }
  return out;
}

}  // namespace clipgs
