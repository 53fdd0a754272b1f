#include "measure/metrics.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"

namespace clipgs {
namespace {

Image constant(int width, int height, float rgb, float alpha) {
  Image image(width, height, 4);
  for (size_t i = 0; i < image.pixels(); ++i) {
    image.data[i * 4] = image.data[i * 4 + 1] = image.data[i * 4 + 2] = rgb;
    image.data[i * 4 + 3] = alpha;
  }
  return image;
}

Image noise(int width, int height, std::uint64_t seed) {
  Image image(width, height, 3);
  Rng rng(seed);
  for (float& v : image.data) {
    v = rng.uniform();
  }
  return image;
}

// SSIM of one pixel and channel straight from the definition: a two-dimensional window, zeros
// outside the picture.
double naive_ssim(const Image& a, const Image& b, int px, int py, int channel) {
  double norm = 0;
  for (int v = -5; v <= 5; ++v) {
    for (int u = -5; u <= 5; ++u) {
      norm += std::exp(-(u * u + v * v) / 4.5);
    }
  }
  double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
  for (int v = -5; v <= 5; ++v) {
    for (int u = -5; u <= 5; ++u) {
      const int x = px + u, y = py + v;
      const bool inside = x >= 0 && y >= 0 && x < a.width && y < a.height;
      const double va = inside ? a.at(x, y)[channel] : 0.0;
      const double vb = inside ? b.at(x, y)[channel] : 0.0;
      const double w = std::exp(-(u * u + v * v) / 4.5) / norm;
      ma += w * va;
      mb += w * vb;
      aa += w * va * va;
      bb += w * vb * vb;
      ab += w * va * vb;
    }
  }
  return (2 * ma * mb + 1e-4) * (2 * (ab - ma * mb) + 9e-4) /
         ((ma * ma + mb * mb + 1e-4) * (aa - ma * ma + bb - mb * mb + 9e-4));
}

TEST(Psnr, OfAConstantDifference) {
  EXPECT_NEAR(psnr(constant(8, 4, 0.5f, 1), constant(8, 4, 0.6f, 1)), 20.0, 1e-4);
  EXPECT_NEAR(psnr(constant(8, 4, 0.0f, 1), constant(8, 4, 1.0f, 1)), 0.0, 1e-9);
}

TEST(Psnr, CompositesStraightAlphaOverBlack) {
  // 0.8 at alpha 0.5 is 0.4 over black, 0.1 less than an opaque 0.5.
  EXPECT_NEAR(psnr(constant(3, 3, 0.8f, 0.5f), constant(3, 3, 0.5f, 1)), 20.0, 1e-4);
}

TEST(Psnr, OfEqualPicturesIsCapped) {
  const Image image = constant(5, 5, 0.3f, 1);
  EXPECT_EQ(psnr(image, image), kMaxPsnr);
  EXPECT_EQ(psnr_from_mse(1e-20), kMaxPsnr);
}

TEST(MaskedPsnr, CountsOnlyPixelsThatEitherPictureCovers) {
  // Of 4 pixels one is covered in the truth, one in the picture; the errors are 0.1 and 0.3.
  Image truth = constant(4, 1, 0.5f, 0);
  Image picture = truth;
  truth.at(0, 0)[3] = 1;
  for (int c = 0; c < 3; ++c) {
    picture.at(0, 0)[c] = 0.6f;
    picture.at(1, 0)[c] = 0.3f;
  }
  picture.at(0, 0)[3] = picture.at(1, 0)[3] = 1;
  EXPECT_NEAR(*masked_error(truth, picture).psnr(), -10 * std::log10((0.01 + 0.09) / 2), 1e-4);
  EXPECT_NEAR(psnr(truth, picture), -10 * std::log10((0.01 + 0.09) / 4), 1e-4);
}

TEST(MaskedPsnr, OfTwoEmptyPicturesIsNone) {
  EXPECT_FALSE(masked_error(constant(4, 4, 1, 0.005f), constant(4, 4, 0, 0)).psnr().has_value());
}

TEST(MaskedErrors, AreByClassAndAddUp) {
  const Image truth = noise(8, 8, 1);
  const Image picture = noise(8, 8, 2);
  std::vector<PixelClass> classes(64, PixelClass::kFace);
  std::fill(classes.begin() + 10, classes.begin() + 30, PixelClass::kOpened);
  const ClassErrors errors = masked_errors(truth, picture, classes);
  EXPECT_EQ(errors[0].pixels, 44U);
  EXPECT_EQ(errors[1].pixels, 20U);
  EXPECT_FALSE(errors[2].psnr());
  SquaredError sum = errors[0];
  sum.add(errors[1]);
  EXPECT_NEAR(*sum.psnr(), psnr(truth, picture), 1e-9);
  EXPECT_THROW(masked_errors(truth, picture, std::span(classes).first(63)), Error);
}

TEST(Ssim, MatchesTheDefinitionInsideAndAtTheBorder) {
  const Image a = noise(23, 17, 1);
  const Image b = noise(23, 17, 2);
  const Image map = ssim_map(a, b);
  ASSERT_EQ(map.channels, 1);
  for (const auto& [x, y] : {std::pair{11, 8}, {0, 0}, {22, 16}, {3, 15}}) {
    const double expected =
        (naive_ssim(a, b, x, y, 0) + naive_ssim(a, b, x, y, 1) + naive_ssim(a, b, x, y, 2)) / 3;
    EXPECT_NEAR(*map.at(x, y), expected, 1e-6) << x << "," << y;
  }
}

TEST(Ssim, OfEqualPicturesIsOne) {
  const Image image = noise(16, 16, 3);
  EXPECT_NEAR(ssim(image, image), 1.0, 1e-6);
}

TEST(Ssim, OfTwoConstantsIsTheLuminanceTermInside) {
  // Far from the border variances vanish: (2·0.4·0.6 + C1) / (0.4² + 0.6² + C1).
  const Image map = ssim_map(constant(21, 21, 0.4f, 1), constant(21, 21, 0.6f, 1));
  EXPECT_NEAR(*map.at(10, 10), 0.4801 / 0.5201, 1e-6);
}

TEST(BandSsim, TakesPixelsNearThePlaneOnly) {
  // The camera looks from x = −100 towards +x; the plane x = 0 keeps what lies beyond.
  const Camera camera = look_at({-100, 0, 0}, {0, 0, 0}, {0, 0, 1}, 2, 2);
  const Plane plane{{1, 0, 0}, 0};
  Image depth(2, 2, 1);
  Image map(2, 2, 1);
  map.data = {0.2f, 0.4f, 0.6f, 0.8f};
  const auto depth_of = [&](int x, int y, float target_x) {
    const Vec3 ray =
        camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    return (target_x - camera.position.x) / ray.x;
  };
  *depth.at(0, 0) = depth_of(0, 0, 0.5f);
  *depth.at(1, 0) = depth_of(1, 0, 1.5f);  // 1.5 mm behind: outside a band of 1 mm
  *depth.at(0, 1) = 0;                     // nothing hit
  *depth.at(1, 1) = depth_of(1, 1, -0.5f);
  EXPECT_NEAR(*band_ssim(map, depth, camera, plane, 1.0f), (0.2 + 0.8) / 2, 1e-6);
  EXPECT_FALSE(band_ssim(map, depth, camera, plane, 0.1f).has_value());
}

TEST(Leak, IsEnergyWhereTheCutLeftNothing) {
  // Pixel 0 is kept, pixel 1 cut away, pixel 2 empty even uncut.
  Image truth = constant(3, 1, 0.5f, 0);
  truth.at(0, 0)[3] = 1;
  Image uncut = truth;
  uncut.at(1, 0)[3] = 1;
  Image picture = constant(3, 1, 0.5f, 1);
  for (int c = 0; c < 3; ++c) {
    picture.at(1, 0)[c] = 0.1f;
  }
  EXPECT_NEAR(*leak(truth, uncut, picture).percent(), 100 * 0.01 / 0.25, 1e-4);
  EXPECT_FALSE(leak(constant(3, 1, 0.5f, 0), uncut, picture).percent().has_value());
}

TEST(Metrics, RefusePicturesOfDifferentSize) {
  const Image a = constant(4, 4, 0, 1);
  const Image b = constant(4, 5, 0, 1);
  EXPECT_THROW(psnr(a, b), Error);
  EXPECT_THROW(masked_error(a, b).psnr(), Error);
  EXPECT_THROW(ssim_map(a, b), Error);
  EXPECT_THROW(leak(a, a, b), Error);
}

}  // namespace
}  // namespace clipgs
