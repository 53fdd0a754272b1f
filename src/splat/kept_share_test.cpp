#include "splat/kept_share.h"

#include <gtest/gtest.h>
#include <optional>

#include "core/random.h"
#include "splat/hull.h"

namespace clipgs {
namespace {

constexpr int kSize = 40;
const Sphere kBall{{5, -10, 20}, 60};

Gaussians make_body() {
  constexpr int kCount = 3000;
  Gaussians body(kCount, 0);
  for (int i = 0; i < kCount; ++i) {
    const Vec3 mean = kBall.center + kBall.radius * fibonacci_sphere(i, kCount);
    for (int axis = 0; axis < 3; ++axis) {
      body.plane(Gaussians::kMean + axis)[i] = mean[axis];
    }
  }
  return body;
}

/// Of a pixel, by many rays: which of them have a point within the hull that is kept; nothing if
/// not all pass through it.
std::optional<float> counted_share(const Camera& camera, const Plane& plane, const Hull& hull,
                                   int x, int y) {
  constexpr int kRays = 24;
  int kept = 0;
  for (int i = 0; i < kRays * kRays; ++i) {
    const glm::dvec3 from(camera.position);
    const glm::dvec3 direction(camera.ray_direction(
        static_cast<float>(x) + (static_cast<float>(i % kRays) + 0.5f) / kRays,
        static_cast<float>(y) + (static_cast<float>(i / kRays) + 0.5f) / kRays));
    double enter = 0;
    double leave = 1e9;
    for (size_t d = 0; d < Hull::kDirections; ++d) {
      const glm::dvec3 n(Hull::directions()[d]);
      const double low = (hull.low[d] - glm::dot(n, from)) / glm::dot(n, direction);
      const double high = (hull.high[d] - glm::dot(n, from)) / glm::dot(n, direction);
      enter = std::max(enter, std::min(low, high));
      leave = std::min(leave, std::max(low, high));
    }
    if (enter > leave) {
      return std::nullopt;
    }
    const auto is_kept = [&](double t) {
      return plane.signed_distance(Vec3(from + t * direction)) > 0;
    };
    const double margin = KeptShare::kMargin / camera.fx;
    kept += is_kept(enter * (1 - margin)) || is_kept(leave * (1 + margin)) ? 1 : 0;
  }
  return static_cast<float>(kept) / (kRays * kRays);
}

TEST(KeptShare, IsThatOfRaysThroughAPixel) {
  Rng rng(5);
  const Gaussians body = make_body();
  const Hull hull(body);
  int edges = 0;
  for (int view = 0; view < 40; ++view) {
    const Vec3 from = fibonacci_sphere(view, 40);
    const Camera camera = frame_sphere(kBall, from, 1, kSize, kSize);
    // Seen nearly along itself, from either side.
    const Vec3 across = glm::normalize(glm::cross(from, fibonacci_sphere(view + 7, 50)));
    const Vec3 normal = glm::normalize(across + 0.1f * (rng.uniform() - 0.5f) * from);
    const Plane plane{normal, glm::dot(normal, kBall.center) + 20 * (rng.uniform() - 0.5f)};
    const KeptShare share(camera, plane, body);
    for (int y = 0; y < kSize; y += 3) {
      for (int x = 0; x < kSize; ++x) {
        const std::optional<float> counted = counted_share(camera, plane, hull, x, y);
        if (counted) {
          // A line across a pixel's corner covers up to an eighth more or less than one along a
          // side.
          EXPECT_NEAR(share.at(x, y), *counted, 0.14f);
          edges += *counted > 0 && *counted < 1 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(edges, 200);
}

TEST(KeptShare, IsWholeWherePlanesAreSeenFromAfar) {
  const Camera camera = frame_sphere(kBall, Vec3(0, 0, 1), 1, kSize, kSize);
  const Gaussians body = make_body();
  EXPECT_TRUE(KeptShare(camera, Cut(), body).is_whole());
  EXPECT_TRUE(KeptShare(camera, Plane{{0, 0, -1}, 0}, body).is_whole());  // from the removed side
  EXPECT_TRUE(KeptShare(camera, Plane{{0, 0, 1}, 0}, body).is_whole());   // from behind
  EXPECT_FALSE(KeptShare(camera, Plane{{1, 0, 0}, 0}, body).is_whole());
  // Two edges that meet share a pixel.
  const Cut corner({Plane{{1, 0, 0}, 5}, Plane{{0, 1, 0}, -10}});
  const KeptShare share(camera, corner, body);
  float least = 1;
  float most = 0;
  for (int i = 0; i < kSize * kSize; ++i) {
    least = std::min(least, share.at(i % kSize, i / kSize));
    most = std::max(most, share.at(i % kSize, i / kSize));
  }
  EXPECT_EQ(least, 0);
  EXPECT_EQ(most, 1);
}

}  // namespace
}  // namespace clipgs
