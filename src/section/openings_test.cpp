#include "section/openings.h"

#include <glm/gtx/quaternion.hpp>
#include <gtest/gtest.h>

#include "cinema/picture.h"
#include "cinema/test_scenes.h"
#include "core/image.h"
#include "core/random.h"
#include "section/faces.h"
#include "section/material_table.h"
#include "section/relight.h"

namespace clipgs {
namespace {

using test::make_preset;
using test::make_volume;
using test::point;

constexpr int kBodySize = 64;
constexpr float kHollow = 14;

/// A ball of 1 mm voxels with an off-centre hollow and a rod through that, in air.
Volume make_hollow_body() {
  const Vec3 middle(0.5f * (kBodySize - 1));
  return make_volume(IVec3(kBodySize), [&](const IVec3& at) {
    const Vec3 p = Vec3(at) - middle;
    const float body = 1 / (1 + std::exp((glm::length(p) - 26) / 0.5f));
    const float hollow = 1 / (1 + std::exp((glm::length(p - Vec3(3, 0, 0)) - kHollow) / 0.5f));
    const float rod = 1 / (1 + std::exp((std::hypot(p.x, p.y + 3) - 2.5f) / 0.5f));
    return body * std::max(1 - hollow, rod) * (120 + 40 * std::sin(0.3f * p.z));
  });
}

Preset flesh(float extinction = 20) {
  LightRig rig;
  rig.sky_top = Vec3(0.5f, 0.55f, 0.6f);
  rig.sky_horizon = Vec3(0.35f);
  rig.sky_bottom = Vec3(0.25f, 0.2f, 0.2f);
  rig.keys = {{glm::normalize(Vec3(-0.4f, 0.3f, 0.9f)), Vec3(0.5f, 0.48f, 0.45f), 0.14f}};
  return make_preset(
      {point(20, 0, Vec3(0.8f, 0.5f, 0.4f)), point(40, extinction, Vec3(0.8f, 0.5f, 0.4f)),
       point(180, extinction, Vec3(0.6f, 0.3f, 0.2f))},
      rig, 0.2f);
}

struct Scenery {
  Volume volume = make_hollow_body();
  Preset preset = flesh();
  CinemaScene scene{volume, preset};
  Section section = make_section(volume, preset, {kBodySize});
  Openings openings{section};
};

FaceOptions with(const OpenedLight& light) {
  FaceOptions options;
  options.light = &light;
  return options;
}

Camera above(const Vec3& direction, int size) {
  return frame_sphere({Vec3(0), 28}, glm::normalize(direction), 1, size, size);
}

TEST(EmptySpace, LeapsMeetTheFirstMatterThatSmallStepsMeet) {
  const Volume volume = make_hollow_body();
  const Section section = make_section(volume, flesh(), {kBodySize});
  const EmptySpace empty = find_empty_space(section);
  const MaterialTable materials(section);
  const auto is_matter = [&](const Vec3& index) {
    return materials.of_value(section.value(section.sample(index))).extinction > 0;
  };
  Rng rng(7);
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 start = Vec3(section.dims - 1) * Vec3(rng.uniform(), rng.uniform(), rng.uniform());
    const Vec3 stride = fibonacci_sphere(static_cast<int>(rng.below(3000)), 3000);
    const auto is_inside = [&](const Vec3& at) {
      return glm::all(glm::greaterThanEqual(at, Vec3(0))) &&
             glm::all(glm::lessThanEqual(at, Vec3(section.dims - 1)));
    };
    float slow = 0;
    while (is_inside(start + slow * stride) && !is_matter(start + slow * stride)) {
      slow += 0.02f;
    }
    float fast = 0;
    while (is_inside(start + fast * stride)) {
      const float leap = empty.leap(start + fast * stride, stride);
      if (leap == 0) {
        break;
      }
      fast += leap;
    }
    if (is_inside(start + slow * stride)) {
      EXPECT_LE(fast, slow + 0.05f) << i;
      ++met;
    }
  }
  EXPECT_GT(met, 100);
}

TEST(EmptySpace, KnowsTheAirAroundTheBodyFromThatWithin) {
  const Scenery scenery;
  const auto inside = [&](const Vec3& world) {
    return scenery.openings.is_inside(scenery.section.index_from_world(world));
  };
  EXPECT_TRUE(inside({3, 6, 0}));    // in the hollow
  EXPECT_TRUE(inside({-18, 0, 0}));  // in matter
  EXPECT_FALSE(inside({0, 28, 0}));  // beside the body
}

TEST(Openings, WallsAreWhereTheyAre) {
  const Scenery scenery;
  const Vec3 middle(3, 0, 0);
  int walls = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 direction = fibonacci_sphere(i, 200);
    const Vec3 eye = middle + Vec3(0, 6, 0);
    // The rod stands in the way of some.
    if (direction.y < 0 && std::abs(direction.x) < 0.7f) {
      continue;
    }
    const std::optional<Wall> wall =
        scenery.openings.first_wall(scenery.section, eye, direction, 0, 100);
    ASSERT_TRUE(wall) << i;
    // Matter begins where a seventh of it is there, up to 0.9 mm before.
    EXPECT_NEAR(glm::distance(wall->position, middle), kHollow - 0.5f, 0.5f);
    EXPECT_GT(glm::dot(wall->normal, glm::normalize(middle - wall->position)), 0.9f);
    ++walls;
  }
  EXPECT_GT(walls, 100);
  // A ray that ends before, or leaves the body, meets none.
  EXPECT_FALSE(scenery.openings.first_wall(scenery.section, middle, {1, 0, 0}, 0, 10));
  EXPECT_FALSE(scenery.openings.first_wall(scenery.section, {0, 0, 29}, {0, 0, 1}, 0, 100));
}

// Or rings would be seen around what is nearly flat.
TEST(Openings, WallsDoNotDependOnWhereASearchBegins) {
  const Scenery scenery;
  for (int i = 0; i < 100; ++i) {
    const Vec3 direction = fibonacci_sphere(i, 100);
    const auto from = [&](float begin) {
      return scenery.openings.first_wall(scenery.section, {3, 6, 0}, direction, begin, 100);
    };
    const std::optional<Wall> wall = from(0);
    ASSERT_TRUE(wall);
    for (const float begin : {0.11f, 0.23f, 0.37f}) {
      const std::optional<Wall> same = from(begin);
      ASSERT_TRUE(same);
      EXPECT_LT(glm::distance(same->position, wall->position), 0.06f) << i;
      EXPECT_LT(glm::distance(same->reflectance, wall->reflectance), 0.01f) << i;
    }
  }
}

// What walls of `section` look like beside the path tracer's under a cut, dB of display sRGB.
double walls_psnr(const CinemaScene& scene, const Section& section, const Cut& cut,
                  const Vec3& from) {
  const Camera camera = above(from, 96);
  const Openings openings(section);
  PictureOptions options;
  options.spp = 96;
  const Image truth = render_picture(scene, camera, cut, options).mean();
  const Image without = draw_faces(section, camera, cut);
  const Image faces = draw_faces(section, camera, cut, with(OpenedLight(openings, cut)));
  double squares = 0;
  double values = 0;
  for (size_t i = 0; i < faces.data.size(); i += 4) {
    if (faces.data[i + 3] < 0.999f || without.data[i + 3] > 0) {
      continue;  // no wall
    }
    for (size_t c = 0; c < 3; ++c) {
      const double shown =
          srgb_from_linear(section.exposure * truth.data[i + c]) - faces.data[i + c];
      squares += shown * shown;
      ++values;
    }
  }
  EXPECT_GT(values, 600);
  return -10 * std::log10(squares / values);
}

// No splats here: what is opaque of the volume's picture is faces and walls alone.
TEST(Openings, LookAsThePathTracerSays) {
  const Scenery scenery;
  ASSERT_TRUE(scenery.openings.drawn());
  EXPECT_TRUE(scenery.openings.outlined());
  const std::vector<std::pair<Cut, Vec3>> looks = {
      {Plane{{0, 0, -1}, 0}, {0.2f, 0.3f, 1}},
      {Plane{glm::normalize(Vec3(0.6f, 0, -0.8f)), -2}, {-0.9f, 0.2f, 0.8f}},
      {Cut({Plane{{0, 0, -1}, -1}, Plane{{0, -1, 0}, -2}}), {0, 0.8f, 1}}};
  for (const auto& [cut, from] : looks) {
    EXPECT_GT(walls_psnr(scenery.scene, scenery.section, cut, from), 29)
        << cut.planes()[0].normal.x;
  }
}

TEST(Openings, HaveABoundarysLookWhereValuesAreSteep) {
  const Volume volume = make_hollow_body();
  Preset preset = flesh();
  const Plane cut{{0, 0, -1}, 0};
  const Vec3 from(0.2f, 0.3f, 1);
  for (const SteepRange range : {SteepRange{5, 20}, SteepRange{20, 120}, SteepRange{200, 300}}) {
    preset.boundary = BoundaryLook{range, TransferFunction({point(20, 0, Vec3(0.2f, 0.4f, 0.8f))})};
    const CinemaScene scene(volume, preset);
    Section section = make_section(volume, preset, {kBodySize});
    const double same = walls_psnr(scene, section, cut, from);
    EXPECT_GT(same, 28) << range.from;
    section.steep.reset();
    const double without = walls_psnr(scene, section, cut, from);
    if (range.from < 100) {
      EXPECT_LT(without, same - 6) << range.from;
    } else {  // nothing is so steep
      EXPECT_EQ(without, same);
    }
  }
}

TEST(Openings, CoverWhatIsBehindAndLeaveFacesAlone) {
  const Scenery scenery;
  const Plane plane{{0, 0, -1}, 0};
  const Camera camera = above({0.2f, 0.3f, 1}, 64);
  const Image without = draw_faces(scenery.section, camera, plane);
  const Image faces =
      draw_faces(scenery.section, camera, plane, with(OpenedLight(scenery.openings, plane)));
  const float* middle = faces.at(36, 36);
  EXPECT_EQ(middle[3], 1);
  EXPECT_EQ(without.at(36, 36)[3], 0);
  int same = 0;
  for (size_t i = 0; i < faces.data.size(); i += 4) {
    EXPECT_GE(faces.data[i + 3], without.data[i + 3] - 1e-5f);
    same += without.data[i + 3] > 0.999f && faces.data[i] == without.data[i] ? 1 : 0;
  }
  EXPECT_GT(same, 300);
  // Nothing is opened where nothing is cut.
  EXPECT_EQ(
      draw_faces(scenery.section, camera, Cut(), with(OpenedLight(scenery.openings, Cut()))).data,
      draw_faces(scenery.section, camera, Cut()).data);
}

TEST(Openings, OfGreyFacesAreWallsWhereTheWindowIsBlack) {
  const Scenery scenery;
  const Plane plane{{0, 0, -1}, 0};
  const Camera camera = above({0.2f, 0.3f, 1}, 64);
  const OpenedLight light(scenery.openings, plane);
  using Style = FaceStyle::Openings;
  const auto drawn = [&](float grey, Style openings, float center = 100, float width = 160) {
    FaceOptions options = with(light);
    options.style = {grey, {center, width}, openings};
    return draw_faces(scenery.section, camera, plane, options);
  };
  const Image cinematic = drawn(0, Style::kCinematic);
  const Image lit = drawn(1, Style::kCinematic);
  const Image half = drawn(0.5f, Style::kCinematic);
  const Image clay = drawn(1, Style::kNeutral);
  const Image values = drawn(1, Style::kValues);
  const auto color = [](const Image& image, int x, int y) {
    const float* c = image.at(x, y);
    return Vec3(c[0], c[1], c[2]);
  };
  // In the hollow: the wall as it is, however grey the face; or of clay, bluer than it is red; or
  // black.
  EXPECT_EQ(color(lit, 36, 36), color(cinematic, 36, 36));
  EXPECT_EQ(color(half, 36, 36), color(cinematic, 36, 36));
  EXPECT_GT(color(clay, 36, 36).b, 1.2f * color(clay, 36, 36).r);
  EXPECT_EQ(color(values, 36, 36), Vec3(0));
  EXPECT_EQ(values.at(36, 36)[3], 1);
  // Beside it all are the same grey.
  const Vec3 grey = color(values, 14, 36);
  EXPECT_GT(grey.r, 0.1f);
  EXPECT_EQ(grey.r, grey.b);
  EXPECT_EQ(color(lit, 14, 36), grey);
  EXPECT_EQ(color(clay, 14, 36), grey);
  // Where the window shows the gap's values they are shown.
  EXPECT_EQ(drawn(1, Style::kCinematic, 0, 400).data, drawn(1, Style::kValues, 0, 400).data);
}

TEST(Openings, OfTranslucentMatterAreLeftToSplats) {
  const Preset glass = flesh(0.1f);
  const Section section = make_section(make_hollow_body(), glass, {kBodySize});
  const Openings openings(section);
  EXPECT_FALSE(openings.drawn());
  EXPECT_FALSE(openings.outlined());
  const Plane plane{{0, 0, -1}, 0};
  const Camera camera = above({0.2f, 0.3f, 1}, 48);
  EXPECT_EQ(draw_faces(section, camera, plane, with(OpenedLight(openings, plane))).data,
            draw_faces(section, camera, plane).data);
}

// Splats on the skin, as flat as trained ones are.
Gaussians skin_splats() {
  Gaussians splats(300, 1);
  for (size_t i = 0; i < splats.size(); ++i) {
    const Vec3 outwards = fibonacci_sphere(static_cast<int>(i), 300);
    const Quat turned = glm::rotation(Vec3(0, 0, 1), outwards);
    const Vec3 mean = 25.2f * outwards;
    for (int k = 0; k < 3; ++k) {
      splats.plane(Gaussians::kMean + k)[i] = mean[k];
      splats.plane(Gaussians::kLogScale + k)[i] = std::log(k == 2 ? 0.3f : 2.0f);
      splats.plane(Gaussians::kSh + k)[i] = 0.2f;
      splats.plane(Gaussians::kSh + 3 + k)[i] = 0.1f;
    }
    splats.plane(Gaussians::kRotation)[i] = turned.w;
    splats.plane(Gaussians::kRotation + 1)[i] = turned.x;
    splats.plane(Gaussians::kRotation + 2)[i] = turned.y;
    splats.plane(Gaussians::kRotation + 3)[i] = turned.z;
  }
  return splats;
}

TEST(Relight, ChangesNothingUnderTheSameLight) {
  const Scenery scenery;
  const Gaussians splats = skin_splats();
  for (const ToneCurve tone : {ToneCurve::kSrgb, ToneCurve::kFilmic}) {
    const Gaussians same = relit(splats, OpenedLight(scenery.openings, Cut()), tone);
    for (size_t i = 0; i < splats.data().size(); ++i) {
      EXPECT_NEAR(same.data()[i], splats.data()[i], 1e-5f);
    }
  }
}

TEST(Relight, FollowsTheRig) {
  Scenery scenery;
  const Gaussians splats = skin_splats();
  // Twice as much of everything.
  LightRig rig = scenery.preset.rig;
  rig.sky_top *= 2;
  rig.sky_horizon *= 2;
  rig.sky_bottom *= 2;
  rig.keys[0].radiance *= 2;
  scenery.openings.set_rig(rig);
  for (const ToneCurve tone : {ToneCurve::kSrgb, ToneCurve::kFilmic}) {
    const Gaussians brighter = relit(splats, OpenedLight(scenery.openings, Cut()), tone);
    for (size_t i = 0; i < splats.size(); ++i) {
      const float before = 0.5f + kShBand0 * splats.plane(Gaussians::kSh)[i];
      const float after = 0.5f + kShBand0 * brighter.plane(Gaussians::kSh)[i];
      const float expected = display_from_linear(2 * linear_from_display(before, tone), tone);
      EXPECT_NEAR(after, expected, 0.01f) << i;
      EXPECT_NEAR(brighter.plane(Gaussians::kSh + 3)[i] / splats.plane(Gaussians::kSh + 3)[i],
                  after / before, 1e-4f);
    }
  }
  // A lamp from below, and nothing else: what looks down is lit.
  rig.sky_top = rig.sky_horizon = rig.sky_bottom = Vec3(0.02f);
  rig.keys[0].direction = {0, 0, -1};
  scenery.openings.set_rig(rig);
  const OpenedLight light(scenery.openings, Cut());
  EXPECT_GT(light.gain({0, 0, -26.5f}, {0, 0, 1}).g, 1.2f);
  EXPECT_LT(light.gain({0, 0, 26.5f}, {0, 0, 1}).g, 0.15f);
  // Nothing is known far from any surface.
  EXPECT_EQ(light.gain({0, 0, 0.5f}, {0, 0, 1}), Vec3(1));
}

}  // namespace
}  // namespace clipgs
