#include "train/loss.h"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/parallel.h"
#include "core/random.h"

namespace clipgs {
namespace {

Image random_premultiplied(int width, int height, std::uint64_t seed) {
  Image image(width, height, 4);
  Rng rng(seed);
  for (size_t i = 0; i < image.pixels(); ++i) {
    const float alpha = rng.uniform();
    for (int c = 0; c < 3; ++c) {
      image.data[i * 4 + c] = alpha * rng.uniform();
    }
    image.data[i * 4 + 3] = alpha;
  }
  return image;
}

/// The loss written down directly, in double precision.
double reference_loss(const std::vector<double>& predicted, const Image& truth,
                      const Vec3& background, const LossWeights& weights) {
  const int w = truth.width;
  const int h = truth.height;
  const auto over = [&](double color, double alpha, int c) {
    return color + (1 - alpha) * background[c];
  };
  double window[11];
  double window_sum = 0;
  for (int k = 0; k < 11; ++k) {
    window[k] = std::exp(-(k - 5) * (k - 5) / 4.5);
    window_sum += window[k];
  }
  double l1 = 0;
  double ssim = 0;
  double alpha = 0;
  for (int y = 0; y < h; ++y) {
    for (int x = 0; x < w; ++x) {
      const size_t i = (static_cast<size_t>(y) * w + x) * 4;
      alpha += std::abs(predicted[i + 3] - truth.data[i + 3]) / (w * h);
      for (int c = 0; c < 3; ++c) {
        l1 += std::abs(over(predicted[i + c], predicted[i + 3], c) -
                       over(truth.data[i + c], truth.data[i + 3], c)) /
              (3 * w * h);
        double mx = 0, my = 0, mxx = 0, myy = 0, mxy = 0;
        for (int dy = -5; dy <= 5; ++dy) {
          for (int dx = -5; dx <= 5; ++dx) {
            if (x + dx < 0 || x + dx >= w || y + dy < 0 || y + dy >= h) {
              continue;
            }
            const size_t j = (static_cast<size_t>(y + dy) * w + x + dx) * 4;
            const double g = window[dx + 5] * window[dy + 5] / (window_sum * window_sum);
            const double a = over(predicted[j + c], predicted[j + 3], c);
            const double b = over(truth.data[j + c], truth.data[j + 3], c);
            mx += g * a;
            my += g * b;
            mxx += g * a * a;
            myy += g * b * b;
            mxy += g * a * b;
          }
        }
        const double c1 = 1e-4, c2 = 9e-4;
        ssim += (2 * mx * my + c1) * (2 * (mxy - mx * my) + c2) /
                ((mx * mx + my * my + c1) * (mxx - mx * mx + myy - my * my + c2)) / (3 * w * h);
      }
    }
  }
  return (1 - weights.dssim) * l1 + weights.dssim * (1 - ssim) + weights.alpha * alpha;
}

TEST(ImageLoss, EqualsTheDefinitionAndItsFiniteDifferences) {
  const Image predicted = random_premultiplied(13, 17, 1);
  const Image truth = random_premultiplied(13, 17, 2);
  const Vec3 background(0.2f, 0.9f, 0.5f);
  const LossWeights weights{0.35f, 0.4f};
  Image gradient;
  ImageLoss loss;
  const double value = loss.evaluate(predicted, truth, background, weights, gradient);
  std::vector<double> p(predicted.data.begin(), predicted.data.end());
  EXPECT_NEAR(value, reference_loss(p, truth, background, weights), 1e-5);
  for (size_t i = 0; i < p.size(); i += 7) {
    constexpr double kStep = 1e-6;
    const double saved = p[i];
    p[i] = saved + kStep;
    const double above = reference_loss(p, truth, background, weights);
    p[i] = saved - kStep;
    const double below = reference_loss(p, truth, background, weights);
    p[i] = saved;
    EXPECT_NEAR(gradient.data[i], (above - below) / (2 * kStep), 2e-5) << i;
  }
}

TEST(ImageLoss, IsZeroForEqualPictures) {
  const Image image = random_premultiplied(32, 20, 3);
  Image gradient;
  EXPECT_NEAR(ImageLoss().evaluate(image, image, Vec3(0.3f), {}, gradient), 0, 1e-6);
}

TEST(ImageLoss, SameBytesAtOneAndTwoThreads) {
  const Image predicted = random_premultiplied(150, 130, 4);
  const Image truth = random_premultiplied(150, 130, 5);
  Image gradients[2];
  double values[2];
  for (int threads = 1; threads <= 2; ++threads) {
    set_thread_count(threads);
    values[threads - 1] =
        ImageLoss().evaluate(predicted, truth, Vec3(0.5f), {}, gradients[threads - 1]);
  }
  set_thread_count(0);
  EXPECT_EQ(values[0], values[1]);
  EXPECT_EQ(gradients[0].data, gradients[1].data);
}

}  // namespace
}  // namespace clipgs
