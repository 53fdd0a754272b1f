#include "section/tint.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "core/random.h"
#include "section/test_section.h"

namespace clipgs {
namespace {

constexpr int kWidth = 23;
constexpr int kHeight = 17;

/// Straight or premultiplied noise; a third of the pixels is transparent.
Image noise(std::uint64_t seed, bool premultiply) {
  Image image(kWidth, kHeight, 4);
  Rng rng(seed);
  for (size_t i = 0; i < image.pixels(); ++i) {
    const float alpha = std::max(0.0f, 1.5f * rng.uniform() - 0.5f);
    for (int c = 0; c < 3; ++c) {
      image.data[4 * i + c] = (premultiply ? alpha : 1) * rng.uniform();
    }
    image.data[4 * i + 3] = alpha;
  }
  return image;
}

/// The mean of a block of `factor(pixel)`, of block indices beyond the picture's the nearest.
template <typename Factor>
double block_mean(int column, int row, int block, const Factor& factor) {
  column = std::clamp(column, 0, (kWidth - 1) / block);
  row = std::clamp(row, 0, (kHeight - 1) / block);
  double sum = 0;
  for (int y = row * block; y < std::min((row + 1) * block, kHeight); ++y) {
    for (int x = column * block; x < std::min((column + 1) * block, kWidth); ++x) {
      sum += factor(static_cast<size_t>(y) * kWidth + x);
    }
  }
  return sum / (block * block);
}

/// The mean of four bilinear samples of block means, half a block beside a pixel's middle.
template <typename Factor>
double blurred(int x, int y, int block, const Factor& factor) {
  double sum = 0;
  for (const double dy : {-0.5, 0.5}) {
    for (const double dx : {-0.5, 0.5}) {
      const double u = (x + 0.5) / block + dx - 0.5;
      const double v = (y + 0.5) / block + dy - 0.5;
      for (int corner = 0; corner < 4; ++corner) {
        const double column = std::floor(u) + (corner & 1);
        const double row = std::floor(v) + (corner >> 1);
        const double weight = (1 - std::abs(u - column)) * (1 - std::abs(v - row));
        sum +=
            weight / 4 * block_mean(static_cast<int>(column), static_cast<int>(row), block, factor);
      }
    }
  }
  return sum;
}

TEST(Tint, IsTheRatioOfBlurredColours) {
  const Image faces = noise(1, true);
  const Image surface = noise(2, false);
  Image picture = noise(3, true);
  for (size_t i = 0; i < picture.data.size(); ++i) {
    picture.data[i] = 0.5f * (picture.data[i] + faces.data[i]) + 0.5f * faces.data[i];
  }
  for (const int block : {1, 3, 8}) {
    const Image got = tinted(picture, &faces, surface, block);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const float alpha = surface.at(x, y)[3];
        ASSERT_EQ(got.at(x, y)[3], alpha);
        for (int c = 0; c < 3 && alpha > 0; ++c) {
          const auto beyond = [&](size_t i, int k) {
            return static_cast<double>(
                std::max(0.0f, picture.data[4 * i + k] - faces.data[4 * i + k]));
          };
          const double splats = blurred(
              x, y, block, [&](size_t i) { return surface.data[4 * i + 3] * beyond(i, c); });
          const double own = blurred(x, y, block, [&](size_t i) {
            return surface.data[4 * i + 3] * beyond(i, 3) * surface.data[4 * i + c];
          });
          const double ratio = std::min((splats + 0.1) / (own + 0.1), 1.25);
          EXPECT_NEAR(got.at(x, y)[c], std::min(1.0, ratio * surface.at(x, y)[c]), 1e-4);
        }
      }
    }
  }
}

TEST(Tint, GivesASurfaceTheSplatsColourAndKeepsWhatIsOnIt) {
  Image picture(kWidth, kHeight, 4);
  Image surface(kWidth, kHeight, 4);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec4 splats(0.35f, 0.3f, 0.2f, 1);
      const Vec4 stripes(Vec3(x % 2 == 0 ? 0.2f : 0.4f), 1);
      std::copy_n(&splats[0], 4, picture.at(x, y));
      std::copy_n(&stripes[0], 4, surface.at(x, y));
    }
  }
  const Image got = tinted(picture, nullptr, surface, 4);
  const float* const dark = got.at(10, 8);
  const float* const light = got.at(11, 8);
  EXPECT_NEAR(light[0] / dark[0], 2, 0.02f);
  // Most of the way from the surface's 0.3, not all of it.
  EXPECT_NEAR(0.5f * (light[0] + dark[0]), 0.3375f, 0.01f);
  EXPECT_NEAR(0.5f * (light[2] + dark[2]), 0.225f, 0.01f);
}

TEST(Tint, LeavesASurfaceAsItIsWhereThereAreNoSplats) {
  const Image surface = noise(5, false);
  const Image got = tinted(Image(kWidth, kHeight, 4), nullptr, surface, 4);
  for (size_t i = 0; i < surface.pixels(); ++i) {
    for (size_t c = 0; c < 4 && surface.data[4 * i + 3] > 0; ++c) {
      EXPECT_NEAR(got.data[4 * i + c], surface.data[4 * i + c], 1e-5f);
    }
  }
}

TEST(Tint, BlocksAreAsLargeAPartOfTheBodyInAnyPicture) {
  const Section section = test::ball_section();
  const auto block = [&](int size, float zoom) {
    return tint_block(section, frame_sphere({Vec3(0), 25}, Vec3(0, -1, 0), zoom, size, size));
  };
  EXPECT_EQ(block(256, 1), 1);
  EXPECT_GE(block(1024, 1), 3);
  EXPECT_LE(block(1024, 1), 5);
  EXPECT_NEAR(block(1024, 3), 3 * block(1024, 1), 3);
  EXPECT_EQ(block(8192, 4), 16);
  // From within the body, too.
  Camera inside = frame_sphere({Vec3(0), 25}, Vec3(0, -1, 0), 1, 256, 256);
  inside.position = Vec3(0);
  EXPECT_EQ(tint_block(section, inside), 16);
}

}  // namespace
}  // namespace clipgs
