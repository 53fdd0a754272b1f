#include "cinema/path_tracer.h"

#include <gtest/gtest.h>

#include "cinema/path_draws.h"
#include "cinema/reference_tracer.h"
#include "cinema/scatter.h"
#include "cinema/test_scenes.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

using test::make_preset;
using test::make_volume;
using test::Mean;
using test::phase_point;
using test::point;

constexpr int kManyBounces = 100000;

Camera camera_from(const Vec3& position, const Vec3& target = Vec3(0)) {
  return look_at(position, target, Vec3(0, 0, 1), 64, 64);
}

struct Means {
  Mean radiance;  // of all paths, green
  Mean alpha;
};

// Paths through the middle of the picture, or through a square of half width `spread` px.
std::vector<PathStart> starts(int count, float spread = 0, std::uint64_t seed = 7) {
  Rng rng(seed);
  std::vector<PathStart> result;
  for (int i = 0; i < count; ++i) {
    // A key each: independent samples.
    result.push_back({32 + spread * (2 * rng.uniform() - 1), 32 + spread * (2 * rng.uniform() - 1),
                      rng.next(), 0});
  }
  return result;
}

Means trace(const PathTracer& tracer, int count, float spread = 0) {
  Means means;
  for (const PathSample& sample : tracer.trace(starts(count, spread))) {
    means.radiance.add(sample.radiance.y);
    means.alpha.add(sample.alpha);
  }
  return means;
}

Means trace(const ReferenceTracer& tracer, int count, float spread = 0, std::uint64_t seed = 8) {
  Rng rng(seed);
  Means means;
  for (int i = 0; i < count; ++i) {
    // A point of the square, then one of the pixel about it.
    const float x = 31.5f + spread * (2 * rng.uniform() - 1) + rng.uniform();
    const float y = 31.5f + spread * (2 * rng.uniform() - 1) + rng.uniform();
    const PathSample sample = tracer.trace(x, y, rng);
    means.radiance.add(sample.radiance.y);
    means.alpha.add(sample.alpha);
  }
  return means;
}

void expect_same(const Mean& a, const Mean& b) {
  EXPECT_NEAR(a.value(), b.value(), 4 * std::sqrt(a.variance() + b.variance()) + 1e-6);
}

// Gives every voxel the label of this index.
void label_where(Volume& volume, const std::function<int(const IVec3&)>& index) {
  volume.labels.resize(volume.voxels());
  for (int z = 0; z < volume.dims.z; ++z) {
    for (int y = 0; y < volume.dims.y; ++y) {
      for (int x = 0; x < volume.dims.x; ++x) {
        volume.labels[volume.offset(x, y, z)] = static_cast<std::uint8_t>(index({x, y, z}));
      }
    }
  }
}

TEST(PathTracer, SlabTransmits) {
  Volume volume = make_volume({24, 20, 20}, [](const IVec3&) { return 1.0f; });
  volume.spacing = Vec3(0.5f, 1, 1);
  volume.origin = -0.5f * Vec3(volume.dims - 1) * volume.spacing;
  const Preset preset = make_preset({point(0, 0), point(1, 0.13f)}, test::white_sky());
  const CinemaScene scene(volume, preset);
  const Means means = trace(PathTracer(scene, camera_from({80, 0, 0}), std::nullopt, 1), 40000);
  EXPECT_NEAR(means.alpha.value(), 1 - std::exp(-0.13 * 11.5), means.alpha.tolerance());
}

// Through a uniform slab, the draw of the distance alone decides whether a path meets matter.
TEST(PathTracer, DrawsAreThoseOfPathDraws) {
  constexpr float kExtinction = 0.0625f;
  const Volume slab = make_volume({17, 41, 41}, [](const IVec3&) { return 1.0f; });
  const CinemaScene scene(slab, make_preset({point(0, kExtinction), point(1, kExtinction)}, {}));
  const PathTracer tracer(scene, camera_from({80, 0, 0}), {}, 1);
  std::vector<PathStart> paths;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    paths.push_back({32, 32, path_draws::hash(i / 100), i % 100});
  }
  int same = 0;
  const std::vector<PathSample> samples = tracer.trace(paths);
  for (size_t i = 0; i < paths.size(); ++i) {
    const float u = path_draws::draw(path_draws::kDistance, paths[i].key, paths[i].index);
    same += (-std::log(1 - u) < 16 * kExtinction) == (samples[i].alpha > 0) ? 1 : 0;
  }
  EXPECT_GT(same, 3980);  // all but those that rounding moves across the slab's end
}

TEST(PathTracer, RampTransmits) {
  // Extinction s·x from one side to the other: optical depth s·L²/2.
  const Volume volume =
      make_volume({33, 16, 16}, [](const IVec3& v) { return static_cast<float>(v.x); });
  const Preset preset = make_preset({point(0, 0), point(32, 0.08f)}, test::white_sky());
  const CinemaScene scene(volume, preset);
  for (const float side : {-90.0f, 90.0f}) {
    const Means means = trace(PathTracer(scene, camera_from({side, 0, 0}), std::nullopt, 1), 40000);
    EXPECT_NEAR(means.alpha.value(), 1 - std::exp(-0.08 * 16), means.alpha.tolerance());
  }
}

TEST(PathTracer, ClippedSlabTransmitsWhatIsKept) {
  const Volume volume = make_volume({21, 21, 21}, [](const IVec3&) { return 1.0f; });
  const Preset preset = make_preset({point(0, 0), point(1, 0.1f)}, test::white_sky());
  const CinemaScene scene(volume, preset);
  const Plane plane{Vec3(1, 0, 0), 3};  // keeps 3 … 10 mm
  for (const float side : {-90.0f, 90.0f}) {
    const Means means = trace(PathTracer(scene, camera_from({side, 0, 0}), plane, 1), 40000);
    EXPECT_NEAR(means.alpha.value(), 1 - std::exp(-0.1 * 7), means.alpha.tolerance());
  }
}

// Albedo 1 in a white environment: every path that meets matter brings back exactly white.
TEST(PathTracer, FurnaceBySky) {
  const Volume ball = make_ball(24, 9, 1, 0);
  for (const float surface_strength : {0.0f, 3.0f, 1e6f}) {
    for (const float g : {0.0f, 0.6f}) {
      const Preset preset = make_preset({phase_point(0, 0, g), phase_point(1, 1.5f, g)},
                                        test::white_sky(), surface_strength);
      const CinemaScene scene(ball, preset);
      for (const bool cut : {false, true}) {
        const std::optional<Plane> plane =
            cut ? std::optional(Plane{Vec3(-0.6f, 0, 0.8f), -1}) : std::nullopt;
        const PathTracer tracer(scene, camera_from({60, 20, 10}), plane, kManyBounces);
        int hits = 0;
        for (const PathSample& sample : tracer.trace(starts(300, 3))) {
          if (sample.alpha > 0) {
            ++hits;
            ASSERT_NEAR(sample.radiance.y, 1, 1e-4);
          }
        }
        EXPECT_GT(hits, 200);
      }
    }
  }
}

// A white panorama is a white environment again, now shared between two ways to find it: right in
// the mean, with weights that no path exceeds.
TEST(PathTracer, FurnaceByPanorama) {
  const Volume ball = make_ball(24, 9, 1, 0);
  LightRig rig{Vec3(0), Vec3(0), Vec3(0), {}};
  Image white(8, 4, 3);
  std::ranges::fill(white.data, 1.0f);
  rig.environment = std::make_shared<const Image>(white);
  for (const float surface_strength : {0.0f, 1e6f}) {
    const Preset preset =
        make_preset({phase_point(0, 0, 0.3f), phase_point(1, 1.5f, 0.3f)}, rig, surface_strength);
    const CinemaScene scene(ball, preset);
    const PathTracer tracer(scene, camera_from({60, 20, 10}), std::nullopt, kManyBounces);
    Mean radiance;
    for (const PathSample& sample : tracer.trace(starts(20000, 3))) {
      if (sample.alpha > 0) {
        radiance.add(sample.radiance.y);
      }
    }
    EXPECT_NEAR(radiance.value(), 1, radiance.tolerance());
    EXPECT_LT(radiance.tolerance(), 0.03);
  }
}

// The same by next-event estimation alone.
TEST(PathTracer, FurnaceByKeyLights) {
  const Volume ball = make_ball(24, 9, 1, 0);
  for (const float surface_strength : {0.0f, 1e6f}) {
    const Preset preset = make_preset({phase_point(0, 0, 0.3f), phase_point(1, 1.5f, 0.3f)},
                                      test::white_keys(), surface_strength);
    const CinemaScene scene(ball, preset);
    const PathTracer tracer(scene, camera_from({60, 20, 10}), std::nullopt, kManyBounces);
    const Means means = trace(tracer, 8000);
    EXPECT_NEAR(means.radiance.value() / means.alpha.value(), 1, means.radiance.tolerance());
  }
}

// Highlights: sampling the lobe towards the sky and evaluating it towards lights must agree.
TEST(PathTracer, HighlightIsTheSameByEitherWay) {
  const Volume ball = make_ball(24, 9, 1, 0);
  for (const bool cut : {false, true}) {
    const std::optional<Plane> plane = cut ? std::optional(Plane{Vec3(-1, 0, 0), 0}) : std::nullopt;
    std::array<Means, 2> means;
    for (int i = 0; i < 2; ++i) {
      const Preset preset =
          make_preset({point(0, 0, Vec3(0.5f), 0.8f), point(1, 1.5f, Vec3(0.5f), 0.8f)},
                      i == 0 ? test::white_sky() : test::white_keys(), 1e6f);
      const CinemaScene scene(ball, preset);
      means[static_cast<size_t>(i)] =
          trace(PathTracer(scene, camera_from({60, 20, 10}), plane, kManyBounces), 20000);
    }
    expect_same(means[0].radiance, means[1].radiance);
    EXPECT_GT(means[0].radiance.value(), 0.3);
    EXPECT_LT(means[0].radiance.value(), 0.95);
  }
}

// A volume with everything: anisotropic, turned, rough, with a transfer function that is not
// monotonic, coloured lights, highlights.
struct Everything {
  Volume volume;
  Preset preset;
  Camera camera = camera_from({70, 50, 40});
  Plane plane{glm::normalize(Vec3(-1, -0.5f, -0.2f)), -2};

  explicit Everything(const LightRig& rig);
};

Everything::Everything(const LightRig& rig) {
  Rng noise(3);
  volume = make_volume({40, 30, 26}, [&](const IVec3& v) {
    const Vec3 p = (Vec3(v) - Vec3(20, 15, 13)) / Vec3(17, 12, 10);
    const float shells = 600 * std::sin(5 * glm::dot(p, p));
    return glm::length(p) < 1 ? shells + 100 * noise.normal() : -1000.0f;
  });
  volume.spacing = Vec3(0.8f, 1.1f, 1.6f);
  volume.direction = Mat3(glm::angleAxis(0.7f, glm::normalize(Vec3(1, 2, 3))));
  volume.origin = -(volume.direction * (Vec3(19.5f, 14.5f, 12.5f) * volume.spacing));
  preset = make_preset({point(-500, 0, Vec3(0.3f), 0, 0.4f, -0.5f),
                        point(-100, 0.9f, Vec3(0.8f), 0.3f, 0.4f, 0.6f), point(50, 0, Vec3(0.4f)),
                        point(300, 0, Vec3(0.6f)), point(350, 2.0f, Vec3(0.9f), 0.5f, 0.4f, -0.3f),
                        point(500, 0.2f, Vec3(0.7f), 0, 0.4f, 0.8f)},
                       rig, 0.002f);
}

void expect_agreement(const Everything& e, const CinemaScene& scene, const Cut& cut) {
  const Means fast = trace(PathTracer(scene, e.camera, cut, 4), 60000, 14);
  const Means slow = trace(ReferenceTracer(e.volume, e.preset, e.camera, cut, 4), 30000, 14);
  expect_same(fast.radiance, slow.radiance);
  expect_same(fast.alpha, slow.alpha);
  // Of a path: one light a vertex instead of all costs some, MIS gains under panoramas.
  EXPECT_LT(60000 * fast.radiance.variance(), 1.4 * 30000 * slow.radiance.variance());
  EXPECT_GT(slow.alpha.value(), 0.2);
  EXPECT_LT(slow.alpha.value(), 0.95);
}

// Fast and slow must agree, cut and uncut.
void expect_agreement(const Everything& e) {
  const CinemaScene scene(e.volume, e.preset);
  const Plane across{glm::normalize(Vec3(0.3f, -0.2f, -1)), -3};
  const Plane behind{-across.normal, -10};  // with `across`, a slab
  for (const Cut& cut : {Cut(), Cut(e.plane), Cut({e.plane, across, behind})}) {
    expect_agreement(e, scene, cut);
  }
}

LightRig two_keys() {
  LightRig rig{Vec3(0.9f), Vec3(0.5f), Vec3(0.1f), {}};
  rig.keys = {{glm::normalize(Vec3(1, 1, 1)), Vec3(0.9f), 0.2f},
              {glm::normalize(Vec3(-1, 0.2f, 0)), Vec3(0.4f), 0.0f}};
  return rig;
}

TEST(PathTracer, AgreesWithTheReference) { expect_agreement(Everything(two_keys())); }

TEST(PathTracer, AgreesWithTheReferenceOnLabels) {
  Everything e(two_keys());
  // Checks of 5 voxels: as the transfer function says, hidden, tinted, thinned and tinted.
  e.volume.label_numbers = {0, 3, 5, 1000};
  label_where(e.volume, [](const IVec3& v) { return (v.x / 5 + v.y / 5 + v.z / 5) % 4; });
  e.preset.labels = {{3, {std::nullopt, 0}},
                     {5, {Vec3(0.9f, 0.1f, 0.2f), 1}},
                     {1000, {Vec3(0.1f, 0.9f, 0.4f), 0.4f}}};
  expect_agreement(e);
}

TEST(PathTracer, AgreesWithTheReferenceOnGradientOpacity) {
  Everything e(two_keys());
  e.preset.gradient_opacity = GradientOpacity{100, 500, 0.1f};
  expect_agreement(e);
  e.volume.label_numbers = {0, 3};
  label_where(e.volume, [](const IVec3& v) { return (v.x / 5 + v.y / 5 + v.z / 5) % 2; });
  e.preset.labels = {{3, {Vec3(0.9f, 0.1f, 0.2f), 0.6f}}};
  expect_agreement(e);
}

// Green and gloss change most, and by the value too.
BoundaryLook steep_look() {
  return {{100, 500},
          TransferFunction({point(-500, 0, Vec3(0.9f), 0.4f), point(0, 0, Vec3(0.05f)),
                            point(340, 0, Vec3(0.1f), 0.2f), point(500, 0, Vec3(0.95f), 0.7f)})};
}

TEST(PathTracer, AgreesWithTheReferenceOnBoundaries) {
  Everything e(two_keys());
  e.preset.boundary = steep_look();
  expect_agreement(e);
  e.preset.gradient_opacity = GradientOpacity{100, 500, 0.1f};
  e.volume.label_numbers = {0, 3};
  label_where(e.volume, [](const IVec3& v) { return (v.x / 5 + v.y / 5 + v.z / 5) % 2; });
  e.preset.labels = {{3, {Vec3(0.9f, 0.1f, 0.2f), 0.6f}}};
  expect_agreement(e);
}

// Black where it is steep: a ball's surface, but not the face where it is cut, nor even matter.
TEST(PathTracer, BoundariesLookIsOfSurfacesAlone) {
  const Volume ball = make_ball(48, 18, 100, 0);
  Preset preset = make_preset({point(20, 0, Vec3(1)), point(50, 20, Vec3(1))}, test::white_sky(),
                              /*surface_strength=*/100);
  const CinemaScene plain(ball, preset);
  preset.boundary = BoundaryLook{{5, 20}, TransferFunction({point(20, 0, Vec3(0))})};
  const CinemaScene scene(ball, preset);
  const Camera camera = camera_from({80, 0, 0});
  const auto first = [&](const CinemaScene& s, const Cut& cut) {
    PathOptions options;
    options.features = true;
    Mean albedo;
    for (const PathSample& sample : PathTracer(s, camera, cut, 1, options).trace(starts(500, 10))) {
      albedo.add(sample.albedo.y);
    }
    return albedo.value();
  };
  EXPECT_LT(first(scene, {}), 0.05);
  EXPECT_NEAR(first(scene, Plane{Vec3(-1, 0, 0), 0}), 1, 1e-6);
  // Where the plane runs along the surface, before it, the surface is none of the plane's faces.
  EXPECT_LT(first(scene, Plane{Vec3(-1, 0, 0), -20}), 0.05);
  EXPECT_NEAR(first(plain, {}), 1, 1e-6);
}

TEST(PathTracer, MatterOfOneValueHasNoBoundary) {
  const Volume even = make_volume({24, 20, 20}, [](const IVec3&) { return 1.0f; });
  Preset preset =
      make_preset({point(0, 0, Vec3(0.7f)), point(1, 0.1f, Vec3(0.7f))}, test::white_keys());
  const CinemaScene plain(even, preset);
  preset.boundary = BoundaryLook{{0, 1}, TransferFunction({point(0, 0, Vec3(0))})};
  const CinemaScene scene(even, preset);
  const Camera camera = camera_from({80, 10, 20});
  const Means with = trace(PathTracer(scene, camera, {}, 8), 2000);
  const Means without = trace(PathTracer(plain, camera, {}, 8), 2000);
  EXPECT_EQ(with.radiance.value(), without.radiance.value());
  EXPECT_GT(with.radiance.value(), 0.1);
}

TEST(PathTracer, EvenMatterKeepsTheFloorOfItsExtinction) {
  const Volume slab = make_volume({24, 20, 20}, [](const IVec3&) { return 1.0f; });
  Preset preset = make_preset({point(0, 0), point(1, 0.13f)}, test::white_sky());
  for (const float floor : {0.0f, 0.4f, 1.0f}) {
    preset.gradient_opacity = GradientOpacity{1, 2, floor};
    const CinemaScene scene(slab, preset);
    const Means means = trace(PathTracer(scene, camera_from({80, 0, 0}), {}, 1), 40000);
    const double depth = 0.13 * 23 * static_cast<double>(floor);
    EXPECT_NEAR(means.alpha.value(), 1 - std::exp(-depth), means.alpha.tolerance());
  }
}

// Half as steep as full extinction needs: half of it. At the ends, where the values stop growing,
// the ramp is half as steep.
TEST(PathTracer, ExtinctionGrowsWithSteepness) {
  Volume ramp =
      make_volume({33, 16, 16}, [](const IVec3& v) { return 5 * static_cast<float>(v.x); });
  ramp.spacing = Vec3(0.5f, 1, 1);
  ramp.origin = -0.5f * Vec3(ramp.dims - 1) * ramp.spacing;
  Preset preset = make_preset({point(0, 0.2f), point(160, 0.2f)}, test::white_sky());
  preset.gradient_opacity = GradientOpacity{0, 20, 0};  // the values grow by 10 per mm
  const CinemaScene scene(ramp, preset);
  const Means means = trace(PathTracer(scene, camera_from({90, 0, 0}), {}, 1), 40000);
  const double depth = 0.2 * (15 * 0.5 + 2 * 0.5 * 0.375);
  EXPECT_NEAR(means.alpha.value(), 1 - std::exp(-depth), means.alpha.tolerance());
}

// Half a slab has a label; the draws between voxels make its edge soft but keep the mean.
TEST(PathTracer, OpacityThinsMatter) {
  Volume volume = make_volume({24, 20, 20}, [](const IVec3&) { return 1.0f; });
  volume.label_numbers = {0, 7};
  label_where(volume, [](const IVec3& v) { return v.x < 12 ? 1 : 0; });
  for (const float opacity : {0.0f, 0.3f}) {
    Preset preset = make_preset({point(0, 0), point(1, 0.1f)}, test::white_sky());
    preset.labels[7].opacity = opacity;
    const CinemaScene scene(volume, preset);
    for (const float side : {-80.0f, 80.0f}) {
      const PathTracer tracer(scene, camera_from({side, 0, 0}), {}, 1);
      const Means means = trace(tracer, 40000);
      EXPECT_NEAR(means.alpha.value(), 1 - std::exp(-0.1 * 11.5 * (1 + opacity)),
                  means.alpha.tolerance());
    }
  }
}

TEST(PathTracer, TellsNormalAndDepthOfWhatIsFirstMet) {
  // Depths and normals of a ball's surface, and of the face where it is cut.
  const Volume ball = make_ball(48, 18, 1, 0);
  const Preset preset =
      make_preset({point(0.3f, 0), point(0.7f, 60)}, test::white_sky(), /*surface_strength=*/100);
  const CinemaScene scene(ball, preset);
  const float distance = 60;
  const PathTracer whole(scene, camera_from({0, 0, distance}), {}, 1, {.features = true});
  const Plane plane{Vec3(0, 0, -1), -10};
  const PathTracer cut(scene, camera_from({0, 0, distance}), plane, 1, {.features = true});
  for (const PathSample& sample : whole.trace(starts(200))) {
    ASSERT_EQ(sample.alpha, 1);
    EXPECT_NEAR(sample.depth, distance - 18, 1);
    EXPECT_GT(sample.normal.z, 0.95f);
    EXPECT_NEAR(glm::length(sample.normal), 1, 1e-4);
  }
  for (const PathSample& sample : cut.trace(starts(200))) {
    ASSERT_EQ(sample.alpha, 1);
    EXPECT_NEAR(sample.depth, distance - 10, 0.5);
    EXPECT_LT(glm::length(sample.normal - Vec3(0, 0, 1)), 1e-5f);
  }
}

TEST(PathTracer, ScatteringWithinAMediumHasNoNormal) {
  const Volume block = make_volume({17, 17, 17}, [](const IVec3&) { return 1.0f; });
  const Preset preset = make_preset({point(0, 0.1f), point(1, 0.1f)}, test::white_sky(), 100);
  const CinemaScene scene(block, preset);
  const PathTracer tracer(scene, camera_from({0, 0, 60}), {}, 1, {.features = true});
  for (const PathSample& sample : tracer.trace(starts(200))) {
    if (sample.alpha > 0 && sample.depth > 60 - 7) {  // deeper than the box's face
      EXPECT_EQ(glm::length(sample.normal), 0);
    }
  }
}

TEST(PathTracer, LabelsColourWhatIsFirstMet) {
  Volume block = make_volume({17, 17, 17}, [](const IVec3&) { return 1.0f; });
  block.label_numbers = {0, 2};
  label_where(block, [](const IVec3&) { return 1; });
  Preset preset = make_preset({point(0, 60), point(1, 60)}, test::white_sky());
  const Vec3 red(0.8f, 0.2f, 0.1f);
  preset.labels[2].albedo = red;
  const CinemaScene scene(block, preset);
  const PathTracer tracer(scene, camera_from({0, 0, 60}), Plane{Vec3(0, 0, -1), -1}, 1,
                          {.features = true});
  for (const PathSample& sample : tracer.trace(starts(20))) {
    ASSERT_EQ(sample.alpha, 1);
    EXPECT_LT(glm::length(sample.albedo - red), 1e-6f);
    EXPECT_LT(glm::length(sample.radiance - red), 2e-3f);
  }
}

// Scattered once towards a light behind it, thin matter is as bright as its own phase function
// says.
TEST(PathTracer, EveryValueHasItsOwnPhase) {
  const LightRig rig{Vec3(0), Vec3(0), Vec3(0), {{Vec3(-0.8f, 0.6f, 0), Vec3(1), 0}}};
  const Preset preset =
      make_preset({phase_point(0, 0.01f, -0.5f), phase_point(1, 0.01f, 0.7f)}, rig);
  const auto radiance = [&](float value) {
    const Volume slab = make_volume({24, 20, 20}, [&](const IVec3&) { return value; });
    const CinemaScene scene(slab, preset);
    return trace(PathTracer(scene, camera_from({80, 0, 0}), {}, 1), 20000).radiance.value();
  };
  const double isotropic = radiance(0.5f / 1.2f);
  EXPECT_GT(isotropic, 0);
  for (const float value : {0.0f, 0.25f, 0.75f, 1.0f}) {
    const float g = -0.5f + 1.2f * value;
    const double expected = henyey_greenstein(0.8f, g) / henyey_greenstein(0.8f, 0);
    EXPECT_NEAR(radiance(value) / isotropic, expected, 2e-3 * expected);
  }
}

// The reference finds the window of the panorama by chance alone.
TEST(PathTracer, AgreesWithTheReferenceUnderAPanorama) {
  LightRig rig{Vec3(0.2f), Vec3(0.1f), Vec3(0), {}};
  rig.keys = {{glm::normalize(Vec3(1, 1, 1)), Vec3(0.3f), 0.2f}};
  rig.environment = std::make_shared<const Image>(test::panorama());
  rig.environment_turn = 1;
  expect_agreement(Everything(rig));
}

TEST(PathTracer, AgreesWithTheReferenceUnderLamps) {
  LightRig rig = two_keys();
  rig.keys[0].distance = 1.2f;
  rig.keys[1].distance = 2;
  expect_agreement(Everything(rig));
}

TEST(PathTracer, CutFaceIsLitAsPredicted) {
  const Volume block = make_volume({17, 17, 17}, [](const IVec3&) { return 1.0f; });
  const Vec3 albedo(0.8f, 0.5f, 0.3f);
  LightRig rig{Vec3(0.25f), Vec3(0.25f), Vec3(0.25f), {}};
  const Vec3 towards_light = glm::normalize(Vec3(1, 0, 2));
  rig.keys = {{towards_light, Vec3(0.7f, 0.6f, 0.5f), 0}};
  const Preset preset = make_preset({point(0, 60, albedo), point(1, 60, albedo)}, rig);
  const CinemaScene scene(block, preset);
  const Vec3 normal = glm::normalize(Vec3(0.3f, 0.2f, 1));
  const Plane plane{-normal, -1};  // keeps what lies below; the face looks up
  const PathTracer tracer(scene, camera_from({30, 10, 60}), plane, 4);
  const Vec3 expected =
      albedo * (Vec3(0.25f) + glm::dot(normal, towards_light) * Vec3(0.7f, 0.6f, 0.5f));
  for (const PathSample& sample : tracer.trace(starts(20))) {
    ASSERT_EQ(sample.alpha, 1);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(sample.radiance[c], expected[c], 2e-3f);
    }
  }
}

TEST(PathTracer, RemovedMatterCastsNoShadow) {
  // Two balls on the x axis, the light behind the second one as seen from the first.
  const auto balls = [](bool both) {
    return make_volume({60, 24, 24}, [=](const IVec3& v) {
      const Vec3 p = Vec3(v) - Vec3(0, 11.5f, 11.5f);
      const bool first = glm::length(p - Vec3(14, 0, 0)) < 8;
      const bool second = glm::length(p - Vec3(44, 0, 0)) < 10;
      return first || (both && second) ? 1.0f : 0.0f;
    });
  };
  const LightRig rig{Vec3(0), Vec3(0), Vec3(0), {{Vec3(1, 0, 0), Vec3(1), 0.02f}}};
  const Preset preset = make_preset({point(0, 0), point(1, 2)}, rig, 3);
  const Camera camera = camera_from({10, 60, 0}, {-11, 0, 0});
  const Plane plane{Vec3(-1, 0, 0), -0.5f};  // between the balls; keeps the first
  Volume two = balls(true);
  const Volume one = balls(false);
  const CinemaScene scene_of_two(two, preset);
  const CinemaScene scene_of_one(one, preset);
  const Means cut = trace(PathTracer(scene_of_two, camera, plane, 3), 30000);
  const Means alone = trace(PathTracer(scene_of_one, camera, std::nullopt, 3), 30000);
  const Means shadowed = trace(PathTracer(scene_of_two, camera, std::nullopt, 3), 30000);
  expect_same(cut.radiance, alone.radiance);
  EXPECT_GT(alone.radiance.value(), 0.05);
  EXPECT_LT(shadowed.radiance.value(), 0.5 * alone.radiance.value());

  // Nor does matter that a label hides.
  two.label_numbers = {0, 1};
  label_where(two, [](const IVec3& v) { return v.x > 28 ? 1 : 0; });
  Preset hiding = preset;
  hiding.labels[1].opacity = 0;
  const CinemaScene hidden_scene(two, hiding);
  const Means hidden = trace(PathTracer(hidden_scene, camera, std::nullopt, 3), 30000);
  expect_same(hidden.radiance, alone.radiance);
}

// Seen through a lens of radius R, a point at depth d covers a disc of radius f·R·|1/F − 1/d| px.
// A ball of radius r covers (r/h)² of what a floor h below its middle gets from an even sky.
TEST(PathTracer, FloorCatchesTheShadowOfABall) {
  constexpr float kRadius = 10;
  const Volume ball = make_volume(
      {27, 27, 27}, [](const IVec3& v) { return kRadius - glm::length(Vec3(v) - Vec3(13)); });
  const auto shadow = [&](const LightRig& rig, const Vec3& target) {
    const Preset preset = make_preset({point(-0.05f, 0), point(0.05f, 200)}, rig);
    const CinemaScene scene(ball, preset);
    const Floor floor{Vec3(0, 0, 1), {0, 0, -16}, 1000};
    const Camera camera = look_at({60, 0, 10}, target, Vec3(0, 0, 1), 64, 64);
    return trace(PathTracer(scene, camera, {}, 2, {.floor = floor}), 20000);
  };
  const Vec3 below(0, 0, -16);
  const Means sky = shadow(test::white_sky(), below);
  EXPECT_NEAR(sky.alpha.value(), std::pow(kRadius / 16, 2), 0.01);
  EXPECT_EQ(sky.radiance.value(), 0);
  LightRig lamp{Vec3(0), Vec3(0), Vec3(0), {}};
  for (const float distance : {0.0f, 3.0f}) {
    lamp.keys = {{Vec3(0, 0, 1), Vec3(1), 0.05f, distance}};
    EXPECT_NEAR(shadow(lamp, below).alpha.value(), 1, 0.01);
    EXPECT_EQ(shadow(lamp, {0, 30, -16}).alpha.value(), 0);
  }
  EXPECT_EQ(shadow(test::white_sky(), {0, 0, 300}).alpha.value(), 0);  // looks above the floor
}

// What covers the whole sky leaves no light, whichever lights there are.
TEST(PathTracer, FloorLosesAllLightBelowASlab) {
  const Volume slab = make_volume({81, 81, 5}, [](const IVec3&) { return 1.0f; });
  LightRig rig = two_keys();
  rig.keys[0].distance = 1.5f;
  rig.environment = std::make_shared<const Image>(test::panorama());
  const Preset preset = make_preset({point(0, 200), point(1, 200)}, rig);
  const CinemaScene scene(slab, preset);
  const Floor floor{Vec3(0, 0, 1), {0, 0, -4}, 1000};
  const Camera camera = look_at({60, 0, -3}, {0, 0, -4}, Vec3(0, 0, 1), 64, 64);
  const Means means = trace(PathTracer(scene, camera, {}, 2, {.floor = floor}), 20000);
  EXPECT_NEAR(means.alpha.value(), 1, 0.02);
}

TEST(PathTracer, LensBlursWhatIsNotAtItsFocus) {
  const Volume ball = make_ball(17, 6, 1, 0);
  const CinemaScene scene(ball, make_preset({point(0.4f, 0), point(0.6f, 50)}, test::white_sky()));
  const Camera camera = camera_from({0, 100, 0});
  const auto alpha_at = [&](const Lens& lens, float offset) {
    const PathTracer tracer(scene, camera, {}, 1, {.lens = lens});
    std::vector<PathStart> paths = starts(4000);
    for (PathStart& path : paths) {
      path.x += offset;
    }
    Mean alpha;
    for (const PathSample& sample : tracer.trace(paths)) {
      alpha.add(sample.alpha);
    }
    return alpha.value();
  };
  const float disc = camera.fx * 20 * (1 / 100.0f - 1 / 200.0f);  // px
  float edge = 0;                                                 // the ball's own radius
  while (alpha_at({}, edge) > 0.5) {
    edge += 0.05f;
  }
  EXPECT_EQ(alpha_at({20, 100}, 0), 1);  // at the focus: as sharp as ever
  EXPECT_EQ(alpha_at({20, 100}, 1.5f * edge), 0);
  const float share = edge * edge / (disc * disc);
  EXPECT_NEAR(alpha_at({20, 200}, 0), share, 0.1 * share);
  EXPECT_NEAR(alpha_at({20, 200}, 0.3f * disc), share, 0.1 * share);
  EXPECT_EQ(alpha_at({20, 200}, disc + 1.3f * edge), 0);
}

TEST(PathTracer, FirstHitIsTheSurface) {
  const Volume ball = make_ball(40, 15, 1, 0);
  const Preset preset = make_preset({point(0.4f, 0), point(0.6f, 20)}, test::white_sky());
  const CinemaScene scene(ball, preset);
  const PathTracer whole(scene, camera_from({0, 100, 0}), std::nullopt, 1);
  EXPECT_NEAR(whole.first_hit(32, 32), 85, 1);
  EXPECT_EQ(whole.first_hit(1, 1), 0);
  const PathTracer cut(scene, camera_from({0, 100, 0}), Plane{Vec3(0, -1, 0), -4}, 1);
  EXPECT_NEAR(cut.first_hit(32, 32), 96, 0.2);

  // What a label hides is looked through.
  Volume labelled = ball;
  labelled.label_numbers = {0, 1};
  label_where(labelled, [](const IVec3& v) { return v.y > 25 ? 1 : 0; });
  Preset hiding = preset;
  hiding.labels[1].opacity = 0;
  const CinemaScene hidden(labelled, hiding);
  const PathTracer through(hidden, camera_from({0, 100, 0}), std::nullopt, 1);
  EXPECT_NEAR(through.first_hit(32, 32), 100 - (25.5 - 19.5), 1);

  // So is matter of even values: of a block with a ball in it, the ball's surface is left, which
  // central differences see from a voxel away.
  Preset boundaries = make_preset({point(0, 20), point(1, 20)}, test::white_sky());
  boundaries.gradient_opacity = GradientOpacity{0.1f, 0.3f, 0};
  const CinemaScene shell(ball, boundaries);
  const PathTracer to_shell(shell, camera_from({0, 100, 0}), std::nullopt, 1);
  EXPECT_NEAR(to_shell.first_hit(32, 32), 84, 1);
}

}  // namespace
}  // namespace clipgs
