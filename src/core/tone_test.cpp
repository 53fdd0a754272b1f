#include "core/tone.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "core/image.h"

namespace clipgs {
namespace {

/// As it was published, in double precision.
double published(double x) {
  const double a = 0.15, b = 0.5, c = 0.1, d = 0.2, e = 0.02, f = 0.3;
  return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

constexpr ToneCurve kFilmic = ToneCurve::kFilmic;

TEST(Tone, OfSrgbIsTheSrgbCurveAlone) {
  for (const float light : {-1.0f, 0.0f, 0.001f, 0.18f, 0.7f, 1.0f, 3.0f}) {
    EXPECT_EQ(display_from_linear(light, ToneCurve::kSrgb), srgb_from_linear(light));
    EXPECT_EQ(linear_from_display(light, ToneCurve::kSrgb), linear_from_srgb(light));
  }
}

TEST(Tone, FilmicIsHablesCurveWithItsWhiteAtTwo) {
  EXPECT_NEAR(1 / published(11.2), 1.37906, 1e-5);  // his scale of white
  for (int i = 0; i <= 400; ++i) {
    const double light = 0.005 * i;
    EXPECT_NEAR(toned(static_cast<float>(light), kFilmic), published(2 * light) / published(4),
                1e-6);
  }
  EXPECT_EQ(toned(2, kFilmic), 1);
  EXPECT_EQ(toned(std::numeric_limits<float>::max(), kFilmic), 1);
  EXPECT_EQ(toned(0, kFilmic), 0);
  EXPECT_EQ(toned(-1, kFilmic), 0);
  EXPECT_NEAR(toned(0.18f, kFilmic), 0.18f, 1e-4f);  // exposures hold
}

TEST(Tone, FilmicIncreasesEverMoreSlowlyTowardsWhite) {
  float before = 0;
  for (int i = 1; i <= 2000; ++i) {
    const float shown = display_from_linear(0.001f * static_cast<float>(i), kFilmic);
    EXPECT_GT(shown, before) << i;
    before = shown;
  }
  const auto slope = [](float at) {
    return (toned(at + 0.01f, kFilmic) - toned(at - 0.01f, kFilmic)) / 0.02f;
  };
  for (float at = 0.2f; at < 1.9f; at += 0.1f) {
    EXPECT_GT(slope(at), slope(at + 0.1f)) << at;
  }
  EXPECT_LT(slope(1.9f), 0.3f);
}

TEST(Tone, InverseLeadsBack) {
  for (const ToneCurve tone : {ToneCurve::kSrgb, kFilmic}) {
    for (int i = 0; i <= 2000; ++i) {
      const float light = 0.001f * static_cast<float>(i) * untoned(1, tone) / 2;
      EXPECT_NEAR(untoned(toned(light, tone), tone), light, 1e-5f) << tone_name(tone);
      const float shown = 0.0005f * static_cast<float>(i);
      EXPECT_NEAR(display_from_linear(linear_from_display(shown, tone), tone), shown, 1e-5f)
          << tone_name(tone);
    }
    EXPECT_EQ(untoned(-1, tone), 0);
    EXPECT_EQ(untoned(2, tone), untoned(1, tone));
  }
  EXPECT_EQ(untoned(1, ToneCurve::kSrgb), 1);
  EXPECT_NEAR(untoned(1, kFilmic), 2, 1e-5f);
}

TEST(Tone, HasNames) {
  for (const ToneCurve tone : {ToneCurve::kSrgb, kFilmic}) {
    EXPECT_EQ(tone_of_name(tone_name(tone)), tone);
  }
  EXPECT_EQ(tone_of_name("Filmic"), std::nullopt);
  EXPECT_EQ(tone_names(), "srgb, filmic");
}

}  // namespace
}  // namespace clipgs
