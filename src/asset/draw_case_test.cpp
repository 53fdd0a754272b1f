#include "asset/draw_case.h"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <map>

#include "core/error.h"
#include "section/outline.h"
#include "section/test_section.h"
#include "splat/test_scene.h"

namespace clipgs {
namespace {

Case make_case() { return {random_scene(400, 1, 4), test::ball_section()}; }

/// From the removed side of `plane()`.
Camera camera() { return frame_sphere({Vec3(0), 30}, Vec3(0.3f, 0.2f, -1), 1, 64, 64); }
Plane plane() { return {Vec3(0, 0, 1), 1}; }

TEST(DrawCase, PutsTheFacesInFrontOfTheSplats) {
  const Case contents = make_case();
  const Image both = draw_case(contents, camera(), plane());
  const Image splats = draw_case(contents, camera(), plane(), {.faces = FaceSource::kSplats});
  const Image faces = draw_faces(*contents.section, camera(), plane());
  size_t on_face = 0;
  for (size_t i = 0; i < faces.data.size(); i += 4) {
    for (size_t c = 0; c < 3; ++c) {
      if (faces.data[i + 3] > 0.999f) {
        EXPECT_NEAR(both.data[i + c], faces.data[i + c], 1e-3f);
        ++on_face;
      } else if (faces.data[i + 3] == 0) {
        EXPECT_NEAR(both.data[i + c], splats.data[i + c], 1e-5f);
      }
    }
  }
  EXPECT_GT(on_face, 300U);
  EXPECT_NE(both.data, splats.data);
}

TEST(DrawCase, WithoutASectionSplatsShowTheFaces) {
  const Case contents{make_case().scene};
  const Image expected = render(contents.scene.gaussians, camera(), plane(), ClipOperator::kSoft);
  EXPECT_EQ(draw_case(contents, camera(), plane(), {.clip = ClipOperator::kSoft}).data,
            expected.data);
}

TEST(DrawCase, NoFaceWithoutAPlaneOrFromTheKeptSide) {
  const Case contents = make_case();
  const auto same = [&](const std::optional<Plane>& cut) {
    return draw_case(contents, camera(), cut).data ==
           draw_case(contents, camera(), cut, {.faces = FaceSource::kSplats}).data;
  };
  EXPECT_TRUE(same(std::nullopt));
  EXPECT_TRUE(same(Plane{Vec3(0, 0, -1), -1}));
  EXPECT_FALSE(same(plane()));
}

TEST(DrawCase, FastIsTheReference) {
  const Case contents = make_case();
  const Image fast = draw_case(contents, camera(), plane());
  const Image slow = draw_case(contents, camera(), plane(), {.reference = true});
  double sum = 0;
  for (size_t i = 0; i < fast.data.size(); ++i) {
    sum += std::pow(fast.data[i] - slow.data[i], 2);
  }
  EXPECT_LT(std::sqrt(sum / static_cast<double>(fast.data.size())), 0.02);
}

constexpr float kRadius = 15;  // mm, of test::ball_section()

/// The surface of the ball as flat blue Gaussians: what training leaves of a case with a section.
Scene ball_surface() {
  constexpr int kCount = 3000;
  Scene scene;
  Gaussians& g = scene.gaussians = Gaussians(kCount, 0);
  for (int i = 0; i < kCount; ++i) {
    const Vec3 outward = fibonacci_sphere(i, kCount);
    Mat3 axes;
    axes[2] = outward;
    orthonormal_basis(outward, axes[0], axes[1]);
    const Quat turn = glm::quat_cast(axes);
    const std::array<float, 4> wxyz = {turn.w, turn.x, turn.y, turn.z};
    const auto at = static_cast<size_t>(i);
    for (int k = 0; k < 3; ++k) {
      g.plane(Gaussians::kMean + k)[at] = (kRadius - 0.3f) * outward[k];
      g.plane(Gaussians::kLogScale + k)[at] = std::log(k == 2 ? 0.15f : 0.7f);
    }
    for (int k = 0; k < 4; ++k) {
      g.plane(Gaussians::kRotation + k)[at] = wxyz[static_cast<size_t>(k)];
    }
    g.plane(Gaussians::kOpacity)[at] = 5;
    g.plane(Gaussians::kSh)[at] = g.plane(Gaussians::kSh + 1)[at] = -1.5f;
    g.plane(Gaussians::kSh + 2)[at] = 1.5f;
  }
  return scene;
}

enum class Meets { kNothing, kFace, kSurface };

/// What the ray through a pixel's middle meets first of the cut ball.
Meets first_met(const Camera& camera, const Plane& cut, int x, int y) {
  const Vec3 ray = camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
  const float half = -glm::dot(camera.position, ray);  // to the point nearest to the middle
  const float chord2 =
      kRadius * kRadius - std::pow(glm::length(camera.position + half * ray), 2.0f);
  if (chord2 <= 0) {
    return Meets::kNothing;
  }
  const float enter = half - std::sqrt(chord2);
  if (cut.signed_distance(camera.position + enter * ray) >= 0) {
    return Meets::kSurface;
  }
  const float leave = half + std::sqrt(chord2);
  return cut.signed_distance(camera.position + leave * ray) >= 0 ? Meets::kFace : Meets::kNothing;
}

// While the plane moves and turns no splat shines through the face or hangs over it, and there is
// no hole where they meet: more than a pixel from any border a picture shows one or the other.
TEST(DrawCase, SweepHasNoSeams) {
  constexpr int kSize = 72;  // px of half a millimetre
  const Case contents{ball_surface(), test::ball_section()};
  std::map<Meets, int> seen;
  for (int step = 0; step < 24; ++step) {
    const float turn = 0.13f * static_cast<float>(step);
    const Plane cut{glm::normalize(Vec3(std::sin(turn), 0.4f, std::cos(turn))),
                    0.9f * static_cast<float>(step) - 11};
    const Vec3 from = -cut.normal + Vec3(1.0f, -0.8f, 0.5f);
    const Camera view = frame_sphere({Vec3(0), 18}, from, 1, kSize, kSize);
    const Image picture = draw_case(contents, view, cut);
    for (int y = 2; y + 2 < kSize; ++y) {
      for (int x = 2; x + 2 < kSize; ++x) {
        const Meets met = first_met(view, cut, x, y);
        bool border = false;
        for (int i = 0; i < 25; ++i) {
          border = border || first_met(view, cut, x + i % 5 - 2, y + i / 5 - 2) != met;
        }
        if (border) {
          continue;
        }
        ++seen[met];
        const float* rgba = picture.at(x, y);
        SCOPED_TRACE(fmt::format("step {} at {}, {}", step, x, y));
        if (met == Meets::kNothing) {
          ASSERT_LT(rgba[3], 0.03f);
        } else {
          ASSERT_GT(rgba[3], 0.97f);
          ASSERT_EQ(rgba[2] > rgba[0] + 0.3f, met == Meets::kSurface);
        }
      }
    }
  }
  EXPECT_GT(seen[Meets::kFace], 2500);
  EXPECT_GT(seen[Meets::kSurface], 2500);
}

/// Rms of alpha against what the section has along 3 × 3 rays a pixel.
double error_of_outline(const Image& picture, const Section& section, const Camera& view) {
  double squares = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      double covered = 0;
      for (int i = 0; i < 9; ++i) {
        covered +=
            outline_reference(section, view, Cut(), x + (i % 3 + 0.5) / 3, y + (i / 3 + 0.5) / 3) /
            9;
      }
      squares += std::pow(picture.at(x, y)[3] - covered, 2);
    }
  }
  return std::sqrt(squares / static_cast<double>(picture.pixels()));
}

TEST(DrawCase, EndsWhereTheSectionDoes) {
  Case contents{ball_surface(), test::ball_section()};
  const Camera view = frame_sphere({Vec3(0), kRadius}, Vec3(0.3f, -1, 0.4f), 1, 64, 64);
  const Image round = draw_case(contents, view, std::nullopt);
  prepare_openings(contents);
  const Image sharp = draw_case(contents, view, std::nullopt);
  EXPECT_LT(error_of_outline(sharp, *contents.section, view),
            0.6 * error_of_outline(round, *contents.section, view));
  // Not where splats show all, nor where they are cut in another way than by the plane itself.
  EXPECT_EQ(draw_case(contents, view, std::nullopt, {.faces = FaceSource::kSplats}).data,
            round.data);
  const Plane cut{Vec3(0, 1, 0), 0};
  const DrawOptions soft{.clip = ClipOperator::kSoft};
  const Case unprepared{contents.scene, contents.section};
  const Image got = draw_case(contents, view, cut, soft);
  const Image expected = draw_case(unprepared, view, cut, soft);
  for (size_t i = 3; i < got.data.size(); i += 4) {
    ASSERT_NEAR(got.data[i], expected.data[i], 1e-3f);
  }
}

// Of a case in which nothing is learnt the section shows all that it can.
TEST(DrawCase, PlacedSplatsAddNothingToASurface) {
  Case contents{ball_surface(), test::ball_section()};
  contents.scene.placed = true;
  prepare_openings(contents);
  Case bare = contents;
  bare.scene.gaussians = contents.scene.gaussians.like(0);
  const Camera view = frame_sphere({Vec3(0), kRadius}, Vec3(0.3f, -1, 0.4f), 1, 64, 64);
  const Cut cut = Plane{glm::normalize(Vec3(0.2f, 1, -0.3f)), 2};
  EXPECT_EQ(draw_case(contents, view, cut).data, draw_case(bare, view, cut).data);
  const DrawOptions cued{.cue = {.strength = 0.5f, .near = 40, .far = 80}};
  for (const Image& seen : {draw_case(contents, view, cut), draw_case(contents, view, cut, cued)}) {
    const float* const middle = seen.at(32, 32);
    EXPECT_GT(middle[3], 0.4f);
    EXPECT_GT(middle[0], middle[2]);  // skin, and not the blue of the splats
  }
  // Where no surface is drawn they are all there is.
  const Image splats = draw_case(contents, view, std::nullopt, {.faces = FaceSource::kSplats});
  EXPECT_GT(splats.at(32, 32)[2], splats.at(32, 32)[0] + 0.3f);
}

TEST(DrawCase, NamesOfSources) {
  for (const FaceSource source : {FaceSource::kVolume, FaceSource::kSplats}) {
    EXPECT_EQ(parse_face_source(face_source_name(source)), source);
  }
  EXPECT_THROW(parse_face_source("none"), Error);
}

}  // namespace
}  // namespace clipgs
