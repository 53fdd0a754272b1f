#include "cinema/exposure.h"

#include <gtest/gtest.h>

#include "cinema/test_scenes.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

// A white ball under a white sky of radiance L shows L: whatever L is, it comes out alike.
TEST(AutomaticExposure, MakesUpForTheLight) {
  const Volume ball = make_ball(24, 9, 1, 0);
  for (const float light : {0.1f, 1.0f, 20.0f}) {
    const LightRig rig{Vec3(light), Vec3(light), Vec3(light), {}};
    Preset preset = test::make_preset({test::point(0.4f, 0), test::point(0.6f, 20)}, rig, 3);
    for (const ToneCurve tone : {ToneCurve::kSrgb, ToneCurve::kFilmic}) {
      preset.tone = tone;
      const float exposure = automatic_exposure(CinemaScene(ball, preset), {Vec3(0), 10});
      EXPECT_NEAR(toned(exposure * light, tone), 0.6f, 0.06f);
    }
  }
}

TEST(AutomaticExposure, OfNothingIsThePresets) {
  const Volume ball = make_ball(24, 9, 1, 0);
  Preset preset = test::make_preset({test::point(0, 0), test::point(1, 0)}, test::white_sky());
  preset.exposure = 1.7f;
  EXPECT_EQ(automatic_exposure(CinemaScene(ball, preset), {Vec3(0), 10}), 1.7f);
}

}  // namespace
}  // namespace clipgs
