#include "volume/label_looks.h"

#include <algorithm>
#include <cmath>

#include "core/image.h"

namespace clipgs {
namespace {

/// Linear RGB of a hue in turns, at the palette's saturation and brightness.
Vec3 color_of_hue(float hue) {
  constexpr float kSaturation = 0.6f;
  constexpr float kBrightness = 0.85f;
  Vec3 color;
  for (int c = 0; c < 3; ++c) {
    const float k = std::fmod(5.0f - 2.0f * static_cast<float>(c) + 6.0f * hue, 6.0f);
    const float away = std::clamp(std::min(k, 4.0f - k), 0.0f, 1.0f);
    color[c] = linear_from_srgb(kBrightness * (1.0f - kSaturation * away));
  }
  return color;
}

}  // namespace

std::vector<LabelLook> looks_of_labels(const Volume& volume, const LabelLooks& looks) {
  std::vector<LabelLook> result;
  if (volume.labels.empty()) {
    return result;
  }
  for (const int number : volume.label_numbers) {
    const auto look = looks.find(number);
    result.push_back(look == looks.end() ? LabelLook() : look->second);
  }
  return result;
}

LabelLooks label_palette(const std::vector<int>& numbers) {
  // Steps of the golden ratio keep any number of hues apart.
  constexpr float kGoldenRatio = 0.618034f;
  LabelLooks looks;
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] != 0) {
      const float turns = static_cast<float>(i) * kGoldenRatio;
      looks[numbers[i]].albedo = color_of_hue(turns - std::floor(turns));
    }
  }
  return looks;
}

}  // namespace clipgs
