#include <gtest/gtest.h>

#include "cinema/path_tracer.h"
#include "cinema/test_scenes.h"
#include "core/memory.h"
#include "core/random.h"

namespace clipgs {
namespace {

using test::make_preset;
using test::Mean;
using test::point;

constexpr float kRadius = 8;  // mm, of a ball in air

/// Voxels 1 mm apart, kept in 16 bits; a ball about each of `centers`, in voxels.
Volume balls(const IVec3& dims, const std::vector<Vec3>& centers) {
  constexpr int kSteps = 100;
  Volume volume;
  volume.dims = dims;
  std::vector<float> meaning(kSteps + 1);
  for (int i = 0; i <= kSteps; ++i) {
    meaning[static_cast<size_t>(i)] = static_cast<float>(i) / kSteps;
  }
  std::vector<std::uint16_t> codes(volume.voxels());
  for (const Vec3& center : centers) {
    const IVec3 low = glm::max(IVec3(center - kRadius - 2.0f), IVec3(0));
    const IVec3 high = glm::min(IVec3(center + kRadius + 2.0f), dims - 1);
    for (int z = low.z; z <= high.z; ++z) {
      for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
          const float inside = kRadius - glm::length(Vec3(x, y, z) - center) + 0.5f;
          codes[volume.offset(x, y, z)] =
              static_cast<std::uint16_t>(kSteps * std::clamp(inside, 0.0f, 1.0f));
        }
      }
    }
  }
  volume.values = VoxelValues(std::move(codes), std::move(meaning));
  return volume;
}

struct Seen {
  Mean alpha, light;
};

/// A ball from the side of +x, where nothing else is in the way.
Seen look_at_ball(const CinemaScene& scene, const Vec3& center) {
  constexpr int kPixels = 32;
  const Camera camera = look_at(center + Vec3(60, 0, 0), center, Vec3(0, 0, 1), kPixels, kPixels);
  const PathTracer tracer(scene, camera, Cut(), 3);
  Rng rng(5);
  std::vector<PathStart> starts(40000);
  for (PathStart& start : starts) {
    start = {kPixels * rng.uniform(), kPixels * rng.uniform(), rng.next(), 0};
  }
  Seen seen;
  for (const PathSample& sample : tracer.trace(starts)) {
    seen.alpha.add(sample.alpha);
    seen.light.add(sample.radiance.y);
  }
  return seen;
}

void expect_same(const Mean& a, const Mean& b) {
  EXPECT_NEAR(a.value(), b.value(), 4 * std::sqrt(a.variance() + b.variance()));
}

// Codes beyond the first 2^30 lie more than 2 GiB from the first.
TEST(LargeVolume, OfMoreThan2To30VoxelsIsTracedToItsFarEnd) {
  const IVec3 dims(1021, 1021, 1030);
  const VolumeSize size{dims};
  ASSERT_GT(size.padded_voxels(), std::uint64_t{1} << 30);
  const std::uint64_t needed = size.loaded() + tracing_memory(size);
  if (available_memory() < needed + needed / 4) {
    GTEST_SKIP() << "needs " << gigabytes(needed + needed / 4) << " of memory";
  }
  const Vec3 near(500, 510, 20);
  const Vec3 far(1000, 1000, 1025);  // the last slice cuts it
  const Preset preset = make_preset({point(0.2f, 0, Vec3(0.8f)), point(1, 3, Vec3(0.8f))},
                                    {Vec3(1), Vec3(0.5f), Vec3(0.2f), {}}, 10);
  const Volume volume = balls(dims, {near, far});
  const CinemaScene scene(volume, preset);
  EXPECT_NEAR(scene.grid().value(scene.grid().sample(far)), 1, 1e-3);
  const Seen near_one = look_at_ball(scene, near);
  const Seen far_one = look_at_ball(scene, far);

  const IVec3 small_dims(61, 61, 46);
  const Vec3 to_small = Vec3(small_dims - 1) - Vec3(dims - 1);
  const Volume small = balls(small_dims, {far + to_small});
  const CinemaScene small_scene(small, preset);
  const Seen expected = look_at_ball(small_scene, far + to_small);
  EXPECT_GT(expected.alpha.value(), 0.05);
  expect_same(far_one.alpha, expected.alpha);
  expect_same(far_one.light, expected.light);
  EXPECT_GT(near_one.alpha.value(), expected.alpha.value());
}

}  // namespace
}  // namespace clipgs
