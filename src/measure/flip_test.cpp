#include "measure/flip.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "core/error.h"
#include "measure/metrics.h"

namespace clipgs {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

/// Waves, coarse and fine, on squares; `changed`: fainter, with other waves and a red bar.
Image waves(bool changed) {
  Image image(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) {
        double value = 0.5 + 0.3 * std::sin(0.11 * x * (c + 1) + 0.07 * y) +
                       0.15 * std::sin(0.9 * x - 0.8 * y + c);
        value *= (x / 16 + y / 16) % 2 == 0 ? 0.6 : 1;
        if (changed) {
          value = 0.92 * value + 0.05 * std::sin(0.5 * x + 0.3 * y * (c + 1));
          if (x > 30 && x < 38 && y > 20 && y < 50) {
            value = c == 0 ? 0.9 : 0.2;
          }
        }
        image.at(x, y)[c] = static_cast<float>(std::clamp(value, 0.0, 1.0));
      }
    }
  }
  return image;
}

// What the authors' own program (FLIP.h, version 1.6) says of the same two pictures.
TEST(Flip, SaysWhatTheAuthorsProgramSays) {
  struct Said {
    float pixels_per_degree;
    double mean, corner, bar, square;
  };
  for (const Said& said : {Said{67.02064f, 0.273900, 0.105517, 0.861364, 0.226488},
                           Said{40, 0.283537, 0.125946, 0.964500, 0.238961},
                           Said{25, 0.291392, 0.152495, 0.968505, 0.247937}}) {
    const Image map = flip_map(waves(false), waves(true), said.pixels_per_degree);
    EXPECT_NEAR(mean(map), said.mean, 5e-5) << said.pixels_per_degree;
    EXPECT_NEAR(*map.at(0, 0), said.corner, 5e-5);
    EXPECT_NEAR(*map.at(34, 30), said.bar, 5e-5);
    EXPECT_NEAR(*map.at(10, 40), said.square, 5e-5);
  }
}

TEST(Flip, IsNothingBetweenEqualsAndTheSameBothWays) {
  const Image a = waves(false);
  const Image b = waves(true);
  EXPECT_EQ(mean(flip_map(a, a, 30)), 0);
  EXPECT_EQ(flip_map(a, b, 30).data, flip_map(b, a, 30).data);
}

TEST(Flip, BetweenGreenAndBlueIsAll) {
  Image green(8, 8, 3);
  Image blue(8, 8, 3);
  for (size_t i = 0; i < green.pixels(); ++i) {
    green.data[3 * i + 1] = blue.data[3 * i + 2] = 1;
  }
  EXPECT_NEAR(mean(flip_map(green, blue, 67)), 1, 1e-6);
}

TEST(Flip, LeavesOutWhatIsTooFineToBeSeen) {
  Image grey(64, 64, 3);
  Image checks(64, 64, 3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      for (int c = 0; c < 3; ++c) {
        grey.at(x, y)[c] = srgb_from_linear(0.5f);
        checks.at(x, y)[c] = static_cast<float>((x + y) % 2);
      }
    }
  }
  EXPECT_LT(*flip_map(grey, checks, 120).at(32, 32), 0.03);
  EXPECT_GT(*flip_map(grey, checks, 15).at(32, 32), 0.3);
}

TEST(Flip, RefusesPicturesOfDifferentSizes) {
  EXPECT_THROW(flip_map(Image(8, 8, 3), Image(8, 9, 3), 30), Error);
}

}  // namespace
}  // namespace clipgs
