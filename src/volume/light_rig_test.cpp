#include "volume/light_rig.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

LightRig two_lamps() {
  LightRig rig;
  rig.sky_top = Vec3(0.2f, 0.4f, 0.6f);
  rig.keys = {{{1, 0, 0}, Vec3(2, 1, 1), 0.1f}, {{0, 0, 1}, Vec3(1), 0.2f}};
  rig.environment_turn = 0.5f;
  return rig;
}

TEST(LightRig, IsTurnedFromTheRightTowardsTheFront) {
  const LightRig rig = turned(two_lamps(), 90);
  EXPECT_NEAR(glm::distance(rig.keys[0].direction, Vec3(0, 1, 0)), 0, 1e-6f);
  EXPECT_NEAR(glm::distance(rig.keys[1].direction, Vec3(0, 0, 1)), 0, 1e-6f);
  EXPECT_EQ(rig.keys[0].radiance, Vec3(2, 1, 1));
  EXPECT_NEAR(rig.environment_turn, 0.5f - 0.5f * kPi, 1e-6f);
  EXPECT_EQ(turned(two_lamps(), 0).keys[0].direction, Vec3(1, 0, 0));
}

TEST(LightRig, ALampIsAsBrightAsThoseWhosePlaceItTakes) {
  const LightRig rig = lamp_instead(two_lamps(), {0, -3, 4});
  ASSERT_EQ(rig.keys.size(), 1u);
  EXPECT_NEAR(glm::distance(rig.keys[0].direction, Vec3(0, -0.6f, 0.8f)), 0, 1e-6f);
  EXPECT_FLOAT_EQ(rig.keys[0].radiance.r, 3);
  EXPECT_LT(rig.sky_top.b, 0.5f * two_lamps().sky_top.b);
  EXPECT_GT(lamp_instead(LightRig(), {1, 0, 0}).keys[0].radiance.r, 1);  // of none there were
}

}  // namespace
}  // namespace clipgs
