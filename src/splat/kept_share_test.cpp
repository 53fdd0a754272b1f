#include "splat/kept_share.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

constexpr int kSize = 40;
const Sphere kBody{{5, -10, 20}, 60};

/// Of a pixel, by many rays: which of them have a point between the body's ends that is kept.
float counted_share(const Camera& camera, const Cut& cut, int x, int y) {
  constexpr int kRays = 24;
  const float middle = glm::dot(camera.forward(), kBody.center - camera.position);
  int kept = 0;
  for (int i = 0; i < kRays * kRays; ++i) {
    const Vec3 direction = camera.ray_direction(
        static_cast<float>(x) + (static_cast<float>(i % kRays) + 0.5f) / kRays,
        static_cast<float>(y) + (static_cast<float>(i / kRays) + 0.5f) / kRays);
    const float along = glm::dot(camera.forward(), direction);
    const auto is_kept = [&](float depth) {
      return cut.planes()[0].signed_distance(camera.position + depth / along * direction) > 0;
    };
    kept += is_kept(middle - kBody.radius) || is_kept(middle + kBody.radius) ? 1 : 0;
  }
  return static_cast<float>(kept) / (kRays * kRays);
}

TEST(KeptShare, IsThatOfRaysThroughAPixel) {
  Rng rng(5);
  int edges = 0;
  for (int view = 0; view < 40; ++view) {
    const Vec3 from = fibonacci_sphere(view, 40);
    const Camera camera = frame_sphere(kBody, from, 1, kSize, kSize);
    // Seen nearly along itself, from either side.
    const Vec3 across = glm::normalize(glm::cross(from, fibonacci_sphere(view + 7, 50)));
    const Vec3 normal = glm::normalize(across + 0.02f * (rng.uniform() - 0.5f) * from);
    const Cut cut = Plane{normal, glm::dot(normal, kBody.center) + 20 * (rng.uniform() - 0.5f)};
    const KeptShare share(camera, cut, kBody);
    for (int y = 0; y < kSize; y += 3) {
      for (int x = 0; x < kSize; ++x) {
        const float counted = counted_share(camera, cut, x, y);
        // A line across a pixel's corner covers up to an eighth more or less than one along a side.
        EXPECT_NEAR(share.at(x, y), counted, 0.14f);
        edges += counted > 0 && counted < 1 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(edges, 300);
}

TEST(KeptShare, IsWholeWherePlanesAreSeenFromAfar) {
  const Camera camera = frame_sphere(kBody, Vec3(0, 0, 1), 1, kSize, kSize);
  EXPECT_TRUE(KeptShare(camera, Cut(), kBody).is_whole());
  EXPECT_TRUE(KeptShare(camera, Plane{{0, 0, -1}, 0}, kBody).is_whole());  // from the removed side
  EXPECT_TRUE(KeptShare(camera, Plane{{0, 0, 1}, 0}, kBody).is_whole());   // from behind
  EXPECT_FALSE(KeptShare(camera, Plane{{1, 0, 0}, 0}, kBody).is_whole());
  // Two edges that meet share a pixel.
  const Cut corner({Plane{{1, 0, 0}, 5}, Plane{{0, 1, 0}, -10}});
  const KeptShare share(camera, corner, kBody);
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
