#include "section/faces.h"

#include <cmath>
#include <gtest/gtest.h>

#include "cinema/picture.h"
#include "cinema/test_scenes.h"
#include "core/parallel.h"
#include "core/random.h"

namespace clipgs {
namespace {

using test::make_preset;
using test::make_volume;
using test::point;

constexpr int kSize = 40;

/// A ball of tissues that change smoothly all over; air around it.
Volume make_body() {
  const Vec3 middle(0.5f * (kSize - 1));
  return make_volume(IVec3(kSize), [&](const IVec3& at) {
    const Vec3 p = Vec3(at) - middle;
    const float inside = 1 / (1 + std::exp((glm::length(p) - 15) / 0.6f));
    const float tissue = 100 + 40 * std::sin(0.4f * p.x) + 30 * std::cos(0.3f * p.y + 0.2f * p.z);
    return inside * tissue;
  });
}

/// Lambert, and opaque within a small part of a voxel.
Preset opaque(float specular = 0) {
  LightRig rig;
  rig.sky_top = Vec3(0.36f, 0.38f, 0.4f);
  rig.sky_horizon = Vec3(0.25f);
  rig.sky_bottom = Vec3(0.2f, 0.18f, 0.16f);
  rig.keys = {{glm::normalize(Vec3(-0.5f, 0.7f, 0.5f)), Vec3(0.5f, 0.48f, 0.45f), 0.14f},
              {glm::normalize(Vec3(0.3f, -0.8f, 0.4f)), Vec3(0.3f), 0.25f}};
  return make_preset(
      {point(20, 0, Vec3(0.3f, 0.1f, 0.1f)), point(30, 60, Vec3(0.4f, 0.2f, 0.1f), specular),
       point(100, 60, Vec3(0.7f, 0.4f, 0.3f), specular),
       point(180, 60, Vec3(0.9f, 0.85f, 0.7f), specular)},
      rig, 0.05f);
}

Plane random_plane(Rng& rng) {
  const Vec3 normal = fibonacci_sphere(static_cast<int>(rng.below(5000)), 5000);
  return {normal, 16 * rng.uniform() - 8};
}

/// A camera on the removed side, so that it sees the face.
Camera facing(const Plane& plane, Rng& rng, int size) {
  const Vec3 tilt = fibonacci_sphere(static_cast<int>(rng.below(5000)), 5000);
  const Vec3 direction = glm::normalize(-plane.normal + 0.6f * tilt);
  return frame_sphere({Vec3(0), 20}, direction, 1, size, size);
}

struct Difference {
  double sum = 0;
  double squares = 0;
  double noise = 0;  // variance of the truth's mean, summed
  size_t count = 0;
};

/// Compares opaque face pixels with the tracer's, in linear light.
void compare(const Section& section, const CinemaScene& scene, const Cut& cut, const Camera& camera,
             std::uint64_t seed, Difference& difference) {
  PictureOptions options;
  options.spp = 48;
  options.seed = seed;
  const Picture picture = render_picture(scene, camera, cut, options);
  const Image truth = picture.mean();
  const Image faces = draw_faces(section, camera, cut, {8, 9});
  for (size_t i = 0; i < faces.data.size(); i += 4) {
    if (faces.data[i + 3] < 0.999f) {
      continue;
    }
    for (size_t c = 0; c < 3; ++c) {
      const double error =
          linear_from_srgb(faces.data[i + c]) - scene.preset().exposure * truth.data[i + c];
      difference.sum += error;
      difference.squares += error * error;
      difference.noise += std::pow(picture.half_a.data[i + c] - picture.half_b.data[i + c], 2) / 4;
      ++difference.count;
    }
  }
}

TEST(Faces, OpaqueLambertMatterLooksAsTheTracerShowsIt) {
  const Volume volume = make_body();
  const Preset preset = opaque();
  const CinemaScene scene(volume, preset);
  const Section section = make_section(volume, preset, {64});
  Rng rng(3);
  for (int i = 0; i < 60; ++i) {
    const Plane plane = random_plane(rng);
    const Camera camera = facing(plane, rng, 32);
    Difference d;
    compare(section, scene, plane, camera, static_cast<std::uint64_t>(i), d);
    if (d.count < 60) {
      continue;  // a sliver
    }
    const auto n = static_cast<double>(d.count);
    EXPECT_NEAR(d.sum / n, 0, 0.002) << "plane " << i;
    // The error is the tracer's noise, and the codes' rounding beside it.
    EXPECT_LT(std::sqrt(d.squares / n), std::sqrt(d.noise / n) + 0.004) << "plane " << i;
  }
}

// Faces are of values alone, in the section and in the truth: of matter as dense as presets' too,
// of which one ray in eight comes deeper than what is lit as the face itself.
TEST(Faces, HaveNothingOfABoundarysLook) {
  const Volume volume = make_body();
  for (const float extinction : {60.0f, 4.0f}) {
    Preset preset = opaque();
    std::vector<TransferPoint> points = preset.transfer.points();
    for (size_t i = 1; i < points.size(); ++i) {
      points[i].material.extinction = extinction;
    }
    preset.transfer = TransferFunction(points);
    const CinemaScene plain(volume, preset);
    preset.boundary =
        BoundaryLook{{1, 6}, TransferFunction({point(20, 0, Vec3(0.1f, 0.2f, 0.9f), 0.3f)})};
    const CinemaScene scene(volume, preset);
    Rng rng(4);
    for (int i = 0; i < 8; ++i) {
      const Plane plane = random_plane(rng);
      const Camera camera = facing(plane, rng, 32);
      const Section section = make_section(volume, preset, {64});
      Difference with;
      Difference without;
      compare(section, scene, plane, camera, static_cast<std::uint64_t>(i), with);
      compare(section, plain, plane, camera, static_cast<std::uint64_t>(i), without);
      const auto n = static_cast<double>(with.count);
      EXPECT_NEAR(with.sum / n, without.sum / n, 0.003) << extinction << " plane " << i;
      EXPECT_NEAR(std::sqrt(with.squares / n), std::sqrt(without.squares / n), 0.003)
          << extinction << " plane " << i;
    }
  }
}

TEST(Faces, OfSeveralPlanesLookAsTheTracerShowsThem) {
  const Volume volume = make_body();
  const Preset preset = opaque();
  const CinemaScene scene(volume, preset);
  const Section section = make_section(volume, preset, {64});
  Rng rng(7);
  for (int i = 0; i < 12; ++i) {
    const Plane near = random_plane(rng);
    const Plane slab{-near.normal, -(near.offset + 6)};
    const Cut cut =
        i % 2 == 0 ? Cut({near, random_plane(rng)}) : Cut({near, slab, random_plane(rng)});
    Difference d;
    compare(section, scene, cut, facing(near, rng, 32), static_cast<std::uint64_t>(i), d);
    if (d.count < 60) {
      continue;  // a sliver
    }
    const auto n = static_cast<double>(d.count);
    EXPECT_NEAR(d.sum / n, 0, 0.003) << "cut " << i;
    EXPECT_LT(std::sqrt(d.squares / n), std::sqrt(d.noise / n) + 0.006) << "cut " << i;
  }
}

TEST(Faces, EndsOfTheVolumeLookAsTheTracerShowsThem) {
  const Volume body = make_body();
  const Volume volume = make_volume(IVec3(kSize, kSize, kSize / 2),
                                    [&](const IVec3& at) { return body.at(at.x, at.y, at.z); });
  const Preset preset = opaque();
  const CinemaScene scene(volume, preset);
  const Section section = make_section(volume, preset, {64});
  const float end = volume.world_from_index(Vec3(volume.dims - 1)).z;
  const Plane aside{Vec3(0, 0, -1), -end - 100};  // cuts nothing
  Rng rng(8);
  Difference d;
  for (int i = 0; i < 6; ++i) {
    compare(section, scene, aside, facing({Vec3(0, 0, -1), 0}, rng, 32),
            static_cast<std::uint64_t>(i), d);
  }
  ASSERT_GT(d.count, 2000U);
  const auto n = static_cast<double>(d.count);
  EXPECT_NEAR(d.sum / n, 0, 0.002);
  EXPECT_LT(std::sqrt(d.squares / n), std::sqrt(d.noise / n) + 0.004);
}

TEST(Faces, GlossIsCloseToTheTracers) {
  const Volume volume = make_body();
  const Preset preset = opaque(0.06f);
  const CinemaScene scene(volume, preset);
  const Section section = make_section(volume, preset, {64});
  Rng rng(4);
  Difference d;
  for (int i = 0; i < 20; ++i) {
    const Plane plane = random_plane(rng);
    compare(section, scene, plane, facing(plane, rng, 32), static_cast<std::uint64_t>(i), d);
  }
  EXPECT_NEAR(d.sum / static_cast<double>(d.count), 0, 0.004);
}

double rms(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.data.size(); ++i) {
    sum += std::pow(static_cast<double>(a.data[i]) - b.data[i], 2);
  }
  return std::sqrt(sum / static_cast<double>(a.data.size()));
}

TEST(Faces, FastIsTheReference) {
  const Volume volume = make_body();
  Preset preset = opaque(0.05f);
  Rng rng(5);
  for (const float extinction : {0.5f, 4.0f}) {
    preset.tone = extinction < 1 ? ToneCurve::kSrgb : ToneCurve::kFilmic;
    std::vector<TransferPoint> points = preset.transfer.points();
    for (size_t i = 1; i < points.size(); ++i) {
      points[i].material.extinction = extinction;
    }
    preset.transfer = TransferFunction(points);
    const Section section = make_section(volume, preset, {64});
    for (int i = 0; i < 4; ++i) {
      const Plane plane = random_plane(rng);
      const Camera camera = facing(plane, rng, 40);
      const Image reference = draw_faces_reference(section, camera, plane, 4);
      const Image many = draw_faces(section, camera, plane, {200, 4});
      const Image few = draw_faces(section, camera, plane, {8, 4});
      EXPECT_LT(rms(many, reference), 0.006) << "extinction " << extinction << " plane " << i;
      EXPECT_LT(rms(few, reference), 0.025) << "extinction " << extinction << " plane " << i;
    }
  }
}

TEST(Faces, AreDisplayedByTheToneCurve) {
  Section section = make_section(make_body(), opaque(0.05f), {64});
  const Plane plane{Vec3(0, 0, 1), 2};
  const Camera camera = frame_sphere({Vec3(0), 20}, Vec3(0.2f, 0.1f, -1), 1, 48, 48);
  const Image plain = draw_faces(section, camera, plane, {8, 1});
  section.tone = ToneCurve::kFilmic;
  const Image filmic = draw_faces(section, camera, plane, {8, 1});
  section.exposure = 3;
  const Image bright = draw_faces(section, camera, plane, {8, 1});
  size_t opaque_pixels = 0;
  for (size_t i = 0; i < plain.data.size(); i += 4) {
    for (size_t c = i; c < i + 3 && plain.data[i + 3] == 1; ++c, ++opaque_pixels) {
      const float light = linear_from_srgb(plain.data[c]);
      EXPECT_NEAR(filmic.data[c], display_from_linear(light, section.tone), 3e-5f);
      EXPECT_NEAR(bright.data[c], display_from_linear(3 * light, section.tone), 3e-5f);
    }
  }
  EXPECT_GT(opaque_pixels, 1000U);
}

TEST(Faces, SameBytesAtAnyThreadCount) {
  const Section section = make_section(make_body(), opaque(), {64});
  Rng rng(6);
  const Plane plane = random_plane(rng);
  const Camera camera = facing(plane, rng, 64);
  set_thread_count(1);
  const Image one = draw_faces(section, camera, plane);
  set_thread_count(2);
  const Image two = draw_faces(section, camera, plane);
  set_thread_count(0);
  EXPECT_EQ(one.data, two.data);
}

TEST(Faces, SeenOnlyFromTheRemovedSide) {
  const Section section = make_section(make_body(), opaque(), {64});
  const Plane plane{Vec3(0, 0, 1), 2};
  const Camera above = frame_sphere({Vec3(0), 20}, Vec3(0, 0, 1), 1, 32, 32);
  const Camera below = frame_sphere({Vec3(0), 20}, Vec3(0, 0, -1), 1, 32, 32);
  EXPECT_EQ(draw_faces(section, above, plane).at(16, 16)[3], 0);
  EXPECT_GT(draw_faces(section, below, plane).at(16, 16)[3], 0.99f);
}

TEST(Faces, FacesOfTwoPlanesMeetWithoutASeam) {
  const Section section = make_section(make_body(), opaque(), {64});
  // A wedge is cut away: from the front both faces are seen, and no pixel between them is open.
  const Plane left{glm::normalize(Vec3(1, -1, 0)), -2};
  const Plane right{glm::normalize(Vec3(-1, -1, 0)), -2};
  const Camera camera = frame_sphere({Vec3(0), 20}, Vec3(0, 1, 0), 1, 64, 64);
  const Image both = draw_faces(section, camera, Cut({left, right}));
  for (int x = 20; x < 44; ++x) {
    EXPECT_GT(both.at(x, 32)[3], 0.99f) << x;
  }
  // Where one plane alone would show a face that the other removes, nothing is drawn.
  const Image first = draw_faces(section, camera, left);
  EXPECT_NE(first.data, both.data);
}

TEST(Faces, SlabThinnerThanItsMatterIsSeenThrough) {
  const Volume volume = make_body();
  Preset preset = opaque();
  std::vector<TransferPoint> points = preset.transfer.points();
  for (size_t i = 1; i < points.size(); ++i) {
    points[i].material.extinction = 1;
  }
  preset.transfer = TransferFunction(points);
  const Section section = make_section(volume, preset, {64});
  const Cut slab({Plane{Vec3(0, 0, 1), -0.5f}, Plane{Vec3(0, 0, -1), -0.5f}});
  const Camera camera = frame_sphere({Vec3(0), 20}, Vec3(0, 0, 1), 1, 33, 33);
  const Image image = draw_faces(section, camera, slab);
  EXPECT_NEAR(image.at(16, 16)[3], 1 - std::exp(-1.0f), 0.05f);
}

TEST(Faces, GreyShowsValuesThroughTheWindow) {
  const Section section = make_section(make_body(), opaque(), {64});
  const Plane plane{Vec3(0, 0, 1), 2};
  const Camera camera = frame_sphere({Vec3(0), 20}, Vec3(0.2f, 0.1f, -1), 1, 64, 64);
  FaceOptions options{8, 1, {1, {110, 100}}};
  const Image grey = draw_faces(section, camera, plane, options);
  size_t inside = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Vec3 ray =
          camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const float t = -plane.signed_distance(camera.position) / glm::dot(plane.normal, ray);
      const Vec3 at = camera.position + t * ray;
      const float* rgba = grey.at(x, y);
      if (glm::length(at) > 18.5f) {
        EXPECT_EQ(rgba[3], 0);  // air around the body
      } else if (glm::length(at) < 14) {
        const float value = section.value(section.sample(section.index_from_world(at)));
        EXPECT_EQ(rgba[3], 1);
        EXPECT_NEAR(rgba[0], std::clamp((value - 60) / 100, 0.0f, 1.0f), 1e-3f);
        EXPECT_EQ(rgba[0], rgba[2]);
        ++inside;
      }
    }
  }
  EXPECT_GT(inside, 200u);

  const Image cinematic = draw_faces(section, camera, plane, {8, 1});
  options.style.grey = 0.25f;
  const Image blend = draw_faces(section, camera, plane, options);
  for (size_t i = 0; i < blend.data.size(); ++i) {
    EXPECT_NEAR(blend.data[i], 0.75f * cinematic.data[i] + 0.25f * grey.data[i], 1e-5f);
  }
}

}  // namespace
}  // namespace clipgs
