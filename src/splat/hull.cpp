#include "splat/hull.h"

#include <algorithm>
#include <limits>
#include <mutex>

#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr float kFaint = -2.19722458f;  // logit of opacity 0.1
constexpr size_t kATurn = 16384;

}  // namespace

const std::array<Vec3, Hull::kDirections>& Hull::directions() {
  static const std::array<Vec3, kDirections> all = [] {
    std::array<Vec3, kDirections> spread{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    for (int i = 3; i < kDirections; ++i) {
      spread[static_cast<size_t>(i)] = fibonacci_sphere(i - 3, 2 * (kDirections - 3));
    }
    return spread;
  }();
  return all;
}

Hull::Hull(const Gaussians& gaussians) {
  low.fill(std::numeric_limits<float>::max());
  high.fill(std::numeric_limits<float>::lowest());
  std::array<std::array<float, kDirections>, 3> along;
  for (size_t k = 0; k < kDirections; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      along[static_cast<size_t>(axis)][k] = directions()[k][axis];
    }
  }
  std::mutex mutex;
  const float* opacity = gaussians.plane(Gaussians::kOpacity);
  parallel_for(gaussians.size(), kATurn, [&](size_t begin, size_t end) {
    std::array<float, kDirections> least;
    std::array<float, kDirections> most;
    least.fill(std::numeric_limits<float>::max());
    most.fill(std::numeric_limits<float>::lowest());
    for (size_t i = begin; i < end; ++i) {
      if (opacity[i] < kFaint) {
        continue;
      }
      const Vec3 mean = gaussians.mean(i);
      const Vec3 scale = gaussians.scale(i);
      const float reach = std::max({scale.x, scale.y, scale.z});
      for (size_t k = 0; k < kDirections; ++k) {
        const float t = mean.x * along[0][k] + mean.y * along[1][k] + mean.z * along[2][k];
        least[k] = t - reach < least[k] ? t - reach : least[k];
        most[k] = t + reach > most[k] ? t + reach : most[k];
      }
    }
    const std::lock_guard lock(mutex);  // least and most of all, in any order
    for (size_t k = 0; k < kDirections; ++k) {
      low[k] = std::min(low[k], least[k]);
      high[k] = std::max(high[k], most[k]);
    }
  });
}

}  // namespace clipgs
