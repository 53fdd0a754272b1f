#include "section/surface_splats.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/camera.h"
#include "section/display_curve.h"
#include "section/test_section.h"
#include "splat/render.h"

namespace clipgs {
namespace {

constexpr float kRadius = 15;  // mm, of test::ball_section()

struct Input {
  Section section = test::ball_section();
  SurfaceScan scan = scan_surfaces(section);
  Openings openings{section, scan};
  Gaussians splats = surface_splats(section, scan, openings, 3000);
};

TEST(SurfaceSplats, LieOnTheSurfaceAndFaceTheAir) {
  const Input input;
  EXPECT_NEAR(static_cast<double>(input.splats.size()), 3000, 900);
  for (size_t i = 0; i < input.splats.size(); ++i) {
    const Vec3 mean = input.splats.mean(i);
    ASSERT_NEAR(glm::length(mean), kRadius, 1);
    const Vec3 scale = input.splats.scale(i);
    ASSERT_LT(scale.z, 0.5f * scale.x);
    ASSERT_EQ(scale.x, scale.y);
    const Vec3 axis = glm::mat3_cast(input.splats.rotation(i))[2];
    ASSERT_GT(std::abs(glm::dot(axis, glm::normalize(mean))), 0.95f);
  }
}

TEST(SurfaceSplats, HaveTheColourOfTheirTissueInItsLight) {
  const Input input;
  const DisplayCurve& display = display_curve(input.section.tone);
  for (size_t i = 0; i < input.splats.size(); i += 37) {
    const Vec3 mean = input.splats.mean(i);
    const Vec3 normal = glm::normalize(mean);
    const std::optional<Wall> wall =
        input.openings.first_wall(input.section, mean + 10.0f * normal, -normal, 0, 20);
    ASSERT_TRUE(wall);
    const Vec3 seen = input.section.exposure * wall->reflectance *
                      light_at(input.openings.light().patches(), input.openings.own_light(),
                               wall->position, normal);
    for (int c = 0; c < 3; ++c) {
      const float color = 0.5f + kShBand0 * input.splats.plane(Gaussians::kSh + c)[i];
      EXPECT_NEAR(color, display(seen[c]), 0.06f);
    }
  }
}

TEST(SurfaceSplats, LeaveNoGaps) {
  const Input input;
  const Camera camera = frame_sphere({Vec3(0), kRadius}, Vec3(1, -0.6f, 0.4f), 1, 96, 96);
  const Image picture = render(input.splats, camera, std::nullopt, ClipOperator::kExact);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const Vec3 ray =
          camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      const float miss =
          glm::length(camera.position - glm::dot(camera.position, ray) * ray);  // of the middle
      if (miss < 0.9f * kRadius) {
        ASSERT_GT(picture.at(x, y)[3], 0.9f) << x << ", " << y;
      } else if (miss > 1.15f * kRadius) {
        ASSERT_LT(picture.at(x, y)[3], 0.1f) << x << ", " << y;
      }
    }
  }
}

TEST(KeptSurfaces, LieOnTheSurfaceThatACutKeeps) {
  const Input input;
  const Plane plane{glm::normalize(Vec3(1, 2, -0.5f)), 3};
  const KeptSurfaces kept = kept_surfaces(input.section, scan_surfaces(input.section, true),
                                          input.openings, Cut(plane), 1000);
  // Of the sphere's area what lies beyond the plane.
  const double share = (kRadius - plane.offset) / (2 * kRadius);
  const KeptSurfaces whole =
      kept_surfaces(input.section, scan_surfaces(input.section, true), input.openings, Cut(), 1000);
  EXPECT_NEAR(static_cast<double>(whole.discs.size()), 1000, 350);
  EXPECT_EQ(whole.lit, whole.discs.size());
  EXPECT_NEAR(static_cast<double>(kept.discs.size()), 1000, 350);  // as many on less of it
  for (size_t i = 0; i < kept.discs.size(); ++i) {
    const Vec3 mean = kept.discs.mean(i);
    ASSERT_GT(plane.signed_distance(mean), 0);
    ASSERT_NEAR(glm::length(mean), kRadius, 0.6);
    const Vec3 out = glm::mat3_cast(kept.discs.rotation(i))[2];
    ASSERT_GT(glm::dot(out, glm::normalize(mean)), 0.97f);
  }
  const double coarser = whole.discs.scale(0).x / kept.discs.scale(0).x;
  EXPECT_NEAR(coarser, 1 / std::sqrt(share), 0.2);
}

}  // namespace
}  // namespace clipgs
