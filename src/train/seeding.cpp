#include "train/seeding.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "core/random.h"

namespace clipgs {

Gaussians start_from_points(const std::vector<SeedPoint>& points, size_t count, int sh_degree,
                            std::uint64_t seed) {
  if (points.empty()) {
    throw Error(
        "the dataset has no seed points: nothing in the volume is visible; check the preset");
  }
  count = std::min(count, points.size());
  std::vector<size_t> order(points.size());
  std::iota(order.begin(), order.end(), size_t{0});
  Rng rng(seed);
  for (size_t i = 0; i < count; ++i) {  // the first `count` of a Fisher–Yates shuffle
    const auto remaining = static_cast<std::uint32_t>(order.size() - i);
    std::swap(order[i], order[i + rng.below(remaining)]);
  }
  // Fewer points leave larger gaps.
  const float gap = std::cbrt(static_cast<float>(points.size()) / static_cast<float>(count));
  constexpr float kDeviationPerSpacing = 0.5f;
  constexpr float kOpacity = 0.6f;

  Gaussians gaussians(count, sh_degree);
  for (size_t i = 0; i < count; ++i) {
    const SeedPoint& point = points[order[i]];
    for (int a = 0; a < 3; ++a) {
      gaussians.plane(Gaussians::kMean + a)[i] = point.position[a];
      gaussians.plane(Gaussians::kLogScale + a)[i] =
          std::log(kDeviationPerSpacing * gap * std::max(point.spacing, 1e-3f));
      gaussians.plane(Gaussians::kSh + a)[i] = (point.color[a] - 0.5f) / kShBand0;
    }
    gaussians.plane(Gaussians::kRotation)[i] = 1;
    gaussians.plane(Gaussians::kOpacity)[i] = std::log(kOpacity / (1 - kOpacity));
  }
  return gaussians;
}

}  // namespace clipgs
