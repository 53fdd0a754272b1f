#include "cinema/matter_colors.h"

#include <array>
#include <gtest/gtest.h>

#include "cinema/path_tracer.h"
#include "cinema/reference_tracer.h"
#include "cinema/seed_points.h"
#include "cinema/test_scenes.h"
#include "core/image.h"

namespace clipgs {
namespace {

using test::Mean;

constexpr Vec3 kFlesh(200, 120, 90);  // sRGB, 0…255
constexpr float kPhotoRadius = 12;    // mm

/// A photographed ball on black, of one colour or as `color` says (sRGB, 0…255, of the voxel). Its
/// outermost voxels are half black if `blur` is a voxel.
Volume photographed(float blur, const std::function<Vec3(const IVec3&)>& color) {
  Volume volume = test::make_volume(IVec3(33), [](const IVec3&) { return 0.0f; });
  volume.modality = Modality::kPhoto;
  for (int z = 0; z < 33; ++z) {
    for (int y = 0; y < 33; ++y) {
      for (int x = 0; x < 33; ++x) {
        const float depth = kPhotoRadius - glm::length(volume.world_from_index(Vec3(x, y, z)));
        const float share = std::clamp(0.5f + depth / blur, 0.0f, 1.0f);
        const Vec3 rgb = glm::round(share * color({x, y, z}));
        for (int c = 0; c < 3; ++c) {
          volume.rgb.push_back(static_cast<std::uint8_t>(rgb[c]));
        }
        volume.values.unpack()[volume.offset(x, y, z)] = glm::dot(rgb, kLuminance);
      }
    }
  }
  return volume;
}

Volume flesh(float blur) {
  return photographed(blur, [](const IVec3&) { return kFlesh; });
}

Vec3 linear(const Vec3& srgb) {
  return {linear_from_srgb(srgb.r / 255), linear_from_srgb(srgb.g / 255),
          linear_from_srgb(srgb.b / 255)};
}

Camera camera() { return look_at({40, 30, 20}, Vec3(0), Vec3(0, 0, 1), 64, 64); }

std::vector<PathStart> photo_starts(int count) {
  Rng rng(5);
  std::vector<PathStart> result;
  for (int i = 0; i < count; ++i) {
    result.push_back(
        {32 + 14 * (2 * rng.uniform() - 1), 32 + 14 * (2 * rng.uniform() - 1), rng.next(), 0});
  }
  return result;
}

TEST(MatterColors, SurfacesOfPhotographsHaveTheirOwnColours) {
  const Preset preset = load_preset("photo");
  for (const float blur : {0.01f, 1.0f}) {
    const Volume volume = flesh(blur);
    const CinemaScene scene(volume, preset);
    for (const Cut& cut : {Cut(), Cut(Plane{glm::normalize(Vec3(-1, -1, -0.5f)), -3})}) {
      const PathTracer tracer(scene, camera(), cut, 1, {.features = true});
      std::array<Mean, 3> albedo;
      for (const PathSample& sample : tracer.trace(photo_starts(2000))) {
        ASSERT_EQ(sample.alpha, 1);
        for (int c = 0; c < 3; ++c) {
          albedo[static_cast<size_t>(c)].add(sample.albedo[c]);
        }
      }
      for (int c = 0; c < 3; ++c) {
        const float expected = linear(kFlesh)[c];
        EXPECT_NEAR(albedo[static_cast<size_t>(c)].value(), expected, 0.02 * expected)
            << "blur " << blur;
      }
    }
  }
}

TEST(MatterColors, SeedPointsHaveTheColoursOfTheirMatter) {
  const Preset preset = load_preset("photo");
  std::array<Mean, 3> color;
  for (const SeedPoint& seed : sample_seed_points(flesh(1), preset, 3000, 1)) {
    for (int c = 0; c < 3; ++c) {
      color[static_cast<size_t>(c)].add(linear_from_srgb(seed.color[c]));
    }
  }
  // Whatever the light, which is nearly white: as green as blue as the matter is.
  const Vec3 expected = linear(kFlesh);
  EXPECT_GT(color[0].value(), 0.4 * expected.r);
  EXPECT_NEAR(color[1].value() / color[0].value(), expected.g / expected.r, 0.05);
}

TEST(MatterColors, OnlyVoxelsBesideEmptyOnesChange) {
  Rng rng(3);
  const Volume volume = photographed(1, [&](const IVec3&) {
    return Vec3(120 + 100 * rng.uniform(), 90 + 100 * rng.uniform(), 80 + 100 * rng.uniform());
  });
  const std::vector<std::uint8_t> colors = matter_colors(volume, load_preset("photo").transfer);
  ASSERT_EQ(colors.size(), volume.rgb.size());
  size_t changed = 0;
  for (int z = 0; z < 33; ++z) {
    for (int y = 0; y < 33; ++y) {
      for (int x = 0; x < 33; ++x) {
        const size_t at = 3 * volume.offset(x, y, z);
        const float distance = glm::length(volume.world_from_index(Vec3(x, y, z))) - kPhotoRadius;
        const bool same = std::equal(&colors[at], &colors[at] + 3, &volume.rgb[at]);
        EXPECT_TRUE(same || std::abs(distance) < 3);
        // What interpolation at the surface may see is as bright as matter.
        EXPECT_TRUE(std::abs(distance) > 0.8f || colors[at] > 100) << distance;
        changed += same ? 0 : 1;
      }
    }
  }
  EXPECT_GT(changed, 1000);
  EXPECT_TRUE(matter_colors(test::make_volume(IVec3(2), [](const IVec3&) { return 1.0f; }),
                            load_preset("bone").transfer)
                  .empty());
}

TEST(MatterColors, PathTracerAgreesWithTheReference) {
  Rng rng(4);
  const Volume volume = photographed(1, [&](const IVec3& v) {
    return v.x % 4 < 2 ? Vec3(220, 60, 40 + 40 * rng.uniform()) : Vec3(50, 160, 200);
  });
  const Preset preset = load_preset("photo");
  const CinemaScene scene(volume, preset);
  const PathTracer fast(scene, camera(), {}, 4);
  std::array<Mean, 3> of_fast;
  for (const PathSample& sample : fast.trace(photo_starts(20000))) {
    for (int c = 0; c < 3; ++c) {
      of_fast[static_cast<size_t>(c)].add(sample.radiance[c]);
    }
  }
  const ReferenceTracer slow(volume, preset, camera(), {}, 4);
  std::array<Mean, 3> of_slow;
  for (const PathStart& start : photo_starts(10000)) {
    const PathSample sample =
        slow.trace(start.x - 0.5f + rng.uniform(), start.y - 0.5f + rng.uniform(), rng);
    for (int c = 0; c < 3; ++c) {
      of_slow[static_cast<size_t>(c)].add(sample.radiance[c]);
    }
  }
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(of_fast[c].value(), of_slow[c].value(),
                4 * std::sqrt(of_fast[c].variance() + of_slow[c].variance()));
    EXPECT_GT(of_slow[c].value(), 0.1);
  }
}

}  // namespace
}  // namespace clipgs
