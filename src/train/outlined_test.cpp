#include "train/outlined.h"

#include <cmath>
#include <gtest/gtest.h>

#include "core/random.h"

namespace clipgs {
namespace {

/// Σ w·outlined + the alpha's own L1: a loss whose gradient is known.
double loss_of(const Image& drawn, const Image* faces, const Image& truth, const Image& weights,
               const Image& shares, float alpha_weight) {
  Image outlined;
  outline_by_truth(drawn, faces, truth, outlined);
  double loss = 0;
  for (size_t i = 0; i < drawn.pixels(); ++i) {
    for (size_t c = 0; c < 4; ++c) {
      loss += double{weights.data[4 * i + c]} * outlined.data[4 * i + c];
    }
    loss += double{alpha_weight} * shares.data[i] *
            std::abs(drawn.data[4 * i + 3] - truth.data[4 * i + 3]) /
            static_cast<double>(drawn.pixels());
  }
  return loss;
}

struct Pictures {
  Image drawn{6, 5, 4}, faces{6, 5, 4}, truth{6, 5, 4}, weights{6, 5, 4}, shares{6, 5, 1};
};

/// Alphas where the section alone decides, so that its share is constant.
Pictures random_pictures() {
  Pictures p;
  Rng rng(5);
  for (size_t i = 0; i < p.drawn.pixels(); ++i) {
    const float alpha = 0.3f + 0.6f * rng.uniform();
    const float face = i % 3 == 0 ? 0 : 0.2f * rng.uniform();
    for (size_t c = 0; c < 3; ++c) {
      p.faces.data[4 * i + c] = face * rng.uniform();
      p.drawn.data[4 * i + c] = p.faces.data[4 * i + c] + (alpha - face) * rng.uniform();
      p.weights.data[4 * i + c] = rng.uniform() - 0.5f;
    }
    p.faces.data[4 * i + 3] = face;
    p.drawn.data[4 * i + 3] = alpha;
    p.truth.data[4 * i + 3] = i % 5 == 0 ? 0.1f * face : 0.25f + 0.7f * rng.uniform();
    p.weights.data[4 * i + 3] = rng.uniform() - 0.5f;
    p.shares.data[i] = 1;
  }
  return p;
}

TEST(Outlined, GradientIsThatOfFiniteDifferences) {
  constexpr float kAlphaWeight = 0.3f;
  const Pictures p = random_pictures();
  for (const Image* faces : {static_cast<const Image*>(nullptr), &p.faces}) {
    Image gradient = p.weights;
    outline_by_truth_backward(p.drawn, faces, p.truth, kAlphaWeight, gradient);
    for (size_t i = 0; i < gradient.data.size(); ++i) {
      constexpr float kStep = 3e-3f;
      Image moved = p.drawn;
      moved.data[i] += kStep;
      const double above = loss_of(moved, faces, p.truth, p.weights, p.shares, kAlphaWeight);
      moved.data[i] -= 2 * kStep;
      const double below = loss_of(moved, faces, p.truth, p.weights, p.shares, kAlphaWeight);
      const double expected = (above - below) / (2 * kStep);
      EXPECT_NEAR(gradient.data[i], expected, 4e-3 * (1 + std::abs(expected))) << i;
    }
  }
}

TEST(Outlined, CoversWhatTheTruthDoes) {
  const Pictures p = random_pictures();
  Image outlined;
  outline_by_truth(p.drawn, nullptr, p.truth, outlined);
  for (size_t i = 0; i < p.drawn.pixels(); ++i) {
    const float* const from = &p.drawn.data[4 * i];
    const float* const to = &outlined.data[4 * i];
    EXPECT_FLOAT_EQ(to[3], p.truth.data[4 * i + 3]);
    EXPECT_NEAR(to[0] * from[3], from[0] * to[3], 1e-6f);
  }
}

}  // namespace
}  // namespace clipgs
