#include <functional>
#include <gtest/gtest.h>

#include "cinema/picture.h"
#include "cinema/scene.h"
#include "cinema/seed_points.h"
#include "cinema/test_scenes.h"
#include "cinema/visible_matter.h"

// The same matter on cubes and on thick slices.
namespace clipgs {
namespace {

using test::make_preset;
using test::point;

constexpr float kBallRadius = 15;  // mm
constexpr Vec3 kSlices(0.7f, 0.7f, 3);

/// Values from a function of the world's mm, from `low` to `high` mm of the grid's axes.
Volume sampled(const Vec3& spacing, const Mat3& direction, const Vec3& low, const Vec3& high,
               const std::function<float(const Vec3&)>& value) {
  Volume volume;
  volume.dims = IVec3(glm::ceil((high - low) / spacing)) + 1;
  volume.spacing = spacing;
  volume.direction = direction;
  volume.origin = direction * low;
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        volume.values.unpack().push_back(value(volume.world_from_index(Vec3(x, y, z))));
      }
    }
  }
  return volume;
}

Volume sampled_ball(const Vec3& spacing, const Mat3& direction,
                    const std::function<float(const Vec3&)>& value) {
  return sampled(spacing, direction, -Vec3(kBallRadius + 6), Vec3(kBallRadius + 6), value);
}

/// A ball about the world's origin; its boundary is smooth enough for thick slices.
float ball(const Vec3& p) {
  constexpr float kBlur = 6;  // mm
  return std::clamp(0.5f + (kBallRadius - glm::length(p)) / kBlur, 0.0f, 1.0f);
}

Picture draw(const Volume& volume, const Cut& cut) {
  LightRig rig{Vec3(0.3f), Vec3(0.2f), Vec3(0.1f), {}};
  rig.keys = {{glm::normalize(Vec3(1, 1, 1)), Vec3(0.9f), 0.2f},
              {glm::normalize(Vec3(-1, 0.2f, 0)), Vec3(0.4f), 0.0f}};
  const Preset preset = make_preset({point(0.1f, 0, Vec3(0.8f)), point(1, 1, Vec3(0.8f))}, rig, 20);
  const CinemaScene scene(volume, preset);
  const Camera camera = look_at({50, 40, 45}, Vec3(0), Vec3(0, 0, 1), 48, 48);
  PictureOptions options;
  options.spp = 128;
  return render_picture(scene, camera, cut, options);
}

/// PSNR over black between what two pictures would be without noise.
double likeness(const Picture& a, const Picture& b) {
  const Image x = display(a.mean(), {});
  const Image y = display(b.mean(), {});
  double sum = 0;
  for (size_t i = 0; i < x.data.size(); i += 4) {
    for (size_t c = 0; c < 3; ++c) {
      const float d = x.data[i + c] * x.data[i + 3] - y.data[i + c] * y.data[i + 3];
      sum += static_cast<double>(d) * static_cast<double>(d);
    }
  }
  const auto noise = [](const Picture& p) {
    return std::pow(10.0, -0.1 * static_cast<double>(noise_floor(p, {})));
  };
  const double mse = sum / (0.75 * static_cast<double>(x.data.size())) - noise(a) - noise(b);
  return -10 * std::log10(std::max(mse, 1e-9));
}

// Cubes that interpolate between the slices hold the same matter, and smaller ones that sample the
// ball itself the same but for what the slices lose.
TEST(Anisotropy, ThickSlicesLookAsCubesDo) {
  const Mat3 oblique(glm::angleAxis(0.6f, glm::normalize(Vec3(1, 2, 0.5f))));
  for (const Mat3& direction : {Mat3(1), oblique}) {
    const Volume slices = sampled_ball(kSlices, direction, ball);
    const Volume cubes = sampled_ball(Vec3(mean_spacing(kSlices)), direction,
                                      [&](const Vec3& p) { return slices.sample(p); });
    const Volume small = sampled_ball(Vec3(1), direction, ball);
    for (const Cut& cut : {Cut(), Cut(Plane{glm::normalize(Vec3(-1, -0.5f, -1)), -5})}) {
      const Picture of_slices = draw(slices, cut);
      EXPECT_GT(likeness(of_slices, draw(cubes, cut)), 47);
      EXPECT_GT(likeness(of_slices, draw(small, cut)), 38);
    }
  }
}

// Bands of a sphere with the same height have the same area.
TEST(Anisotropy, SeedPointsCoverEverySideAlike) {
  const Volume slices = sampled_ball(
      kSlices, Mat3(1), [](const Vec3& p) { return glm::length(p) < kBallRadius ? 1.0f : 0.0f; });
  const Preset preset = make_preset({point(0.1f, 0), point(1, 4)}, test::white_sky());
  double caps = 0;
  double equator = 0;
  for (const SeedPoint& seed : sample_seed_points(slices, preset, 20000, 1)) {
    const float distance = glm::length(seed.position);
    const float height = std::abs(seed.position.z) / distance;
    caps += distance > kBallRadius - 4 && height > 0.8f ? 1 : 0;
    equator += distance > kBallRadius - 4 && height < 0.2f ? 1 : 0;
  }
  EXPECT_GT(caps / equator, 0.6);
  EXPECT_LT(caps / equator, 1.6);
}

// A speck far above a ball is none of its matter, however few slices lie between.
TEST(Anisotropy, SpecksAreLeftOutAtAnySpacing) {
  const auto ball_and_speck = [](const Vec3& p) {
    const bool speck = glm::length(p - Vec3(0, 0, kBallRadius + 22)) < 2.5f;
    return speck || glm::length(p) < kBallRadius ? 1.0f : 0.0f;
  };
  const TransferFunction transfer({point(0, 0), point(1, 4)});
  for (const Vec3& spacing : {kSlices, Vec3(1)}) {
    const Volume volume = sampled(spacing, Mat3(1), -Vec3(20), Vec3(20, 20, 45), ball_and_speck);
    const float top = visible_matter(volume, transfer).bounds.max.z;
    EXPECT_NEAR(top, kBallRadius, spacing.z) << spacing.z;
  }
}

}  // namespace
}  // namespace clipgs
