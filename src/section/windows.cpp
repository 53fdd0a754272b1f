#include "section/windows.h"

#include <algorithm>
#include <numeric>

namespace clipgs {
namespace {

Window window_between(float low, float high) { return {0.5f * (low + high), high - low}; }

/// Narrower than this a window shows nothing.
float smallest_width(const ValueCurve& curve) {
  return (curve.values().back() - curve.values().front()) / 1000;
}

Window auto_window(const Section& section) {
  std::array<std::uint64_t, ValueCurve::kCodes> counts{};
  for (const std::uint8_t code : section.voxels) {
    counts[code] += code >= Section::kFirstInside ? 1 : 0;
  }
  const auto total =
      static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
  const auto percentile = [&](double share) {
    std::uint64_t below = 0;
    size_t code = Section::kFirstInside;
    for (; code + 1 < counts.size(); ++code) {
      below += counts[code];
      if (static_cast<double>(below) >= share * total) {
        break;
      }
    }
    return section.curve.values()[code];
  };
  const float low = percentile(0.01);
  return window_between(low, std::max(percentile(0.99), low + smallest_width(section.curve)));
}

}  // namespace

std::vector<NamedWindow> windows_of(const Section& section) {
  if (section.channels == 3) {
    return {};
  }
  if (section.modality == Modality::kCt) {
    return {kCtWindows.begin(), kCtWindows.end()};
  }
  const auto& values = section.curve.values();
  return {{"auto", auto_window(section)},
          {"full", window_between(values[Section::kFirstInside], values.back())}};
}

}  // namespace clipgs
