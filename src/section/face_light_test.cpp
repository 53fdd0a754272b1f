#include "section/face_light.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "cinema/lights.h"
#include "cinema/scatter.h"
#include "core/random.h"

namespace clipgs {
namespace {

LightRig three_lights() {
  LightRig rig;
  rig.sky_top = Vec3(0.4f, 0.5f, 0.6f);
  rig.sky_horizon = Vec3(0.2f);
  rig.sky_bottom = Vec3(0.3f, 0.25f, 0.2f);
  rig.keys = {{glm::normalize(Vec3(-0.55f, 0.7f, 0.55f)), Vec3(0.75f, 0.7f, 0.65f), 0.14f},
              {glm::normalize(Vec3(0.75f, 0.45f, 0.35f)), Vec3(0.2f), 0.31f},
              {Vec3(0, -1, 0), Vec3(0.3f), 0}};
  return rig;
}

float relative_difference(const Vec3& a, const Vec3& b) {
  return glm::length(a - b) / std::max(glm::length(b), 1e-6f);
}

TEST(FaceLight, DiffuseIsTheIntegralOverTheHemisphere) {
  const LightRig rig = three_lights();
  const Lights lights(rig, Mat3(1), Vec3(1));
  for (int i = 0; i < 300; ++i) {
    const Vec3 normal = fibonacci_sphere(i, 300);
    const Vec3 truth = lights.face_radiance(normal);
    // What is left is the quadrature's own error, and that the closed form takes discs as flat.
    EXPECT_LT(relative_difference(face_diffuse(rig, normal), truth), 0.01f)
        << normal.x << " " << normal.y << " " << normal.z;
  }
}

TEST(FaceLight, WhiteSkyGivesOne) {
  const LightRig rig{Vec3(1), Vec3(1), Vec3(1), {}};
  EXPECT_NEAR(face_diffuse(rig, glm::normalize(Vec3(1, 2, 3))).x, 1, 1e-5f);
}

TEST(FaceLight, GlossIsCloseToTheIntegral) {
  const LightRig rig = three_lights();
  const Lights lights(rig, Mat3(1), Vec3(1));
  Rng rng(7);
  double squared_error = 0;
  double squared_truth = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 normal = fibonacci_sphere(static_cast<int>(rng.below(1000)), 1000);
    const Vec3 out = sample_cosine(normal, rng.uniform(), rng.uniform());
    const float roughness = 0.3f + 0.3f * rng.uniform();
    Vec3 truth(0);
    constexpr int kDraws = 4000;
    for (int i = 0; i < kDraws; ++i) {
      float weight = 0;
      const Vec3 in = ggx::sample(normal, out, roughness, rng.uniform(), rng.uniform(), weight);
      truth += weight > 0 ? weight * lights.sky(in) : Vec3(0);
      for (const Lights::Key& key : lights.keys()) {
        const Vec3 towards = key.sample(Vec3(0), rng.uniform(), rng.uniform()).towards;
        truth += ggx::evaluate(normal, out, towards, roughness) * key.irradiance;
      }
    }
    truth /= static_cast<float>(kDraws);
    const Vec3 error = face_gloss(rig, normal, out, roughness) - truth;
    squared_error += glm::dot(error, error);
    squared_truth += glm::dot(truth, truth);
  }
  EXPECT_LT(std::sqrt(squared_error / squared_truth), 0.12);
}

TEST(FaceLight, NoGlossFromBelow) {
  const Vec3 gloss = face_gloss(three_lights(), Vec3(0, 0, 1), Vec3(0, 0, -1), 0.4f);
  EXPECT_EQ(gloss, Vec3(0));
}

}  // namespace
}  // namespace clipgs
