#include "cinema/lights.h"

#include <gtest/gtest.h>

#include "core/random.h"

namespace clipgs {
namespace {

LightRig one_lamp(float distance) {
  LightRig rig{Vec3(0), Vec3(0), Vec3(0), {}};
  rig.keys = {{glm::normalize(Vec3(1, 2, 3)), Vec3(0.9f, 0.5f, 0.1f), 0.3f, distance}};
  return rig;
}

// In the middle of the volume a lamp gives what its radiance says, however far it is.
TEST(Lights, LampsGiveTheMiddleTheSameFromAnyDistance) {
  const Vec3 extent(100, 80, 60);
  for (const float distance : {0.0f, 1.1f, 3.0f, 100.0f}) {
    const LightRig rig = one_lamp(distance);
    const Vec3 light = Lights(rig, Mat3(1), extent).face_radiance(rig.keys[0].direction);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(light[c], rig.keys[0].radiance[c], 0.01f) << "from " << distance;
    }
  }
}

// A face anywhere gets ∫ L·cos·cos'/d² dA; here by points on the disc, one by one.
TEST(Lights, LampsFallOffWithDistance) {
  const Vec3 extent(100);
  const LightRig rig = one_lamp(2);
  const Lights lights(rig, Mat3(1), extent);
  const Lights::Key& key = lights.keys().front();
  const double distance = 2 * 0.5 * static_cast<double>(glm::length(extent));
  const double radius = distance * std::tan(0.3);
  // L = E/π/sin²α, of the lamp's own radiance.
  const double lamp = 0.9 / std::pow(std::sin(0.3), 2);
  const Vec3 position(20, 70, -30);
  Rng rng(3);
  double ours = 0;
  double truth = 0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    ours += static_cast<double>(key.sample(position, rng.uniform(), rng.uniform()).irradiance.x);
    double x = 0;
    double y = 0;
    do {
      x = 2 * static_cast<double>(rng.uniform()) - 1;
      y = 2 * static_cast<double>(rng.uniform()) - 1;
    } while (x * x + y * y > 1);
    const glm::dvec3 point = 0.5 * glm::dvec3(extent) + distance * glm::dvec3(key.direction) +
                             radius * (x * glm::dvec3(key.tangent) + y * glm::dvec3(key.bitangent));
    const glm::dvec3 way = point - glm::dvec3(position);
    const double far = glm::length(way);
    truth += lamp * 3.14159265358979 * radius * radius *
             glm::dot(way / far, glm::dvec3(key.direction)) / (far * far);
  }
  EXPECT_NEAR(ours / truth, 1, 1e-3);
}

}  // namespace
}  // namespace clipgs
