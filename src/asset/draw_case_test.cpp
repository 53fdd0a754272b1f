#include "asset/draw_case.h"

#include <gtest/gtest.h>

#include "core/error.h"
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

TEST(DrawCase, NamesOfSources) {
  for (const FaceSource source : {FaceSource::kVolume, FaceSource::kSplats}) {
    EXPECT_EQ(parse_face_source(face_source_name(source)), source);
  }
  EXPECT_THROW(parse_face_source("none"), Error);
}

}  // namespace
}  // namespace clipgs
