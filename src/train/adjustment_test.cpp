#include "train/adjustment.h"

#include <gtest/gtest.h>

#include "core/parallel.h"
#include "core/random.h"
#include "train/adjustment_kernel.h"
#include "train/truncation.h"

namespace clipgs {
namespace {

const Sphere kSphere{{3, -5, 8}, 60};
constexpr float kExtent = 100;

AdjustmentOptions small_options(float window, bool shape = true) {
  AdjustmentOptions options;
  options.position_octaves = 3;
  options.plane_octaves = 4;
  options.width = 32;
  options.hidden_layers = 2;
  options.window = window;
  options.shape = shape;
  return options;
}

/// With an output layer that is not 0, as after some training.
Adjustment taught(const AdjustmentOptions& options) {
  Adjustment model(options, kSphere, kExtent, 7);
  const size_t last = 10 * static_cast<size_t>(options.width);
  const size_t begin = model.weights().size() - 16 - 16 * static_cast<size_t>(options.width);
  Rng rng(3, 1);
  for (size_t i = 0; i < last; ++i) {
    model.weights()[begin + i] = 0.3f * rng.normal();
  }
  for (size_t o = 0; o < 10; ++o) {
    model.weights()[model.weights().size() - 16 + o] = 0.1f * rng.normal();
  }
  return model;
}

std::vector<AdjustmentInput> random_inputs(size_t count) {
  Rng rng(11, 2);
  std::vector<AdjustmentInput> inputs(count);
  for (AdjustmentInput& input : inputs) {
    input.center = kSphere.center + 40.0f * Vec3(rng.normal(), rng.normal(), rng.normal());
    input.distance = 12.0f * rng.uniform() - 2.0f;
    input.log_scale = Vec3(rng.normal(), rng.normal(), rng.normal());
    const Vec3 normal = glm::normalize(Vec3(rng.normal(), rng.normal(), rng.normal()));
    input.along = normal * normal;
  }
  return inputs;
}

std::vector<float> numbers_of(const std::vector<Adjusted>& list) {
  std::vector<float> numbers;
  for (const Adjusted& added : list) {
    numbers.insert(numbers.end(), added.mean, added.mean + 3);
    numbers.insert(numbers.end(), added.log_scale, added.log_scale + 3);
    numbers.insert(numbers.end(), added.rotation, added.rotation + 4);
  }
  return numbers;
}

TEST(Multiply, IsTheSumOfProducts) {
  Rng rng(5, 1);
  for (const auto& [rows, inner, columns] :
       {std::array<size_t, 3>{1, 1, 16}, {5, 7, 32}, {64, 49, 48}, {10, 64, 16}}) {
    std::vector<float> a(rows * inner), b(inner * columns), out(rows * columns, 0.5f);
    for (std::vector<float>* m : {&a, &b}) {
      for (float& value : *m) {
        value = rng.normal();
      }
    }
    for (const bool transposed : {false, true}) {
      for (const bool add : {false, true}) {
        std::vector<float> got = out;
        multiply({a.data(), transposed ? 1 : inner, transposed ? rows : 1}, b.data(), rows, inner,
                 columns, add, got.data());
        for (size_t r = 0; r < rows; ++r) {
          for (size_t c = 0; c < columns; ++c) {
            double sum = add ? 0.5 : 0;
            for (size_t k = 0; k < inner; ++k) {
              sum += double{transposed ? a[k * rows + r] : a[r * inner + k]} * b[k * columns + c];
            }
            EXPECT_NEAR(got[r * columns + c], sum, 1e-4);
          }
        }
      }
    }
  }
}

TEST(Adjustment, StartsAsTheIdentity) {
  const std::vector<AdjustmentInput> inputs = random_inputs(100);
  const Adjustment model(AdjustmentOptions{}, kSphere, kExtent, 1);
  std::vector<Adjusted> added(100);
  model.forward(inputs, added);
  for (const float value : numbers_of(added)) {
    EXPECT_EQ(value, 0);
  }
}

TEST(Adjustment, FastIsTheReference) {
  const std::vector<AdjustmentInput> inputs = random_inputs(150);
  for (const auto& [window, shape] : {std::pair{0.08f, true}, {0.08f, false}, {0.0f, true}}) {
    const AdjustmentOptions options = small_options(window, shape);
    const Adjustment model = taught(options);
    const std::vector<double> weights(model.weights().begin(), model.weights().end());
    std::vector<Adjusted> added(inputs.size());
    model.forward(inputs, added);
    const std::vector<float> numbers = numbers_of(added);
    double largest = 0;
    for (size_t i = 0; i < added.size(); ++i) {
      const std::vector<double> expected =
          reference_adjustment(options, kSphere, kExtent, weights, inputs[i]);
      for (size_t o = 0; o < expected.size(); ++o) {
        EXPECT_NEAR(numbers[i * 10 + o], expected[o], 2e-4 * (1 + std::abs(expected[o])));
        largest = std::max(largest, std::abs(expected[o]));
      }
    }
    EXPECT_GT(largest, 0.1);
  }
}

TEST(Adjustment, GradientsOfWeightsAreFiniteDifferences) {
  const std::vector<AdjustmentInput> inputs = random_inputs(70);  // more than one block
  for (const auto& [window, shape] : {std::pair{0.1f, true}, {0.1f, false}, {0.0f, true}}) {
    const AdjustmentOptions options = small_options(window, shape);
    const Adjustment model = taught(options);
    // L = Σ gᵢₒ·addedᵢₒ for some g.
    Rng rng(9, 4);
    std::vector<Adjusted> gradient(inputs.size());
    std::vector<double> g;
    for (Adjusted& one : gradient) {
      for (float* list : {one.mean, one.log_scale, one.rotation}) {
        for (int k = 0; k < (list == one.rotation ? 4 : 3); ++k) {
          list[k] = rng.normal();
          g.push_back(list[k]);
        }
      }
    }
    std::vector<float> got;
    model.backward(inputs, gradient, got);
    ASSERT_EQ(got.size(), model.weights().size());
    std::vector<double> weights(model.weights().begin(), model.weights().end());
    const auto loss = [&] {
      double sum = 0;
      for (size_t i = 0; i < gradient.size(); ++i) {
        const std::vector<double> added =
            reference_adjustment(options, kSphere, kExtent, weights, inputs[i]);
        for (size_t o = 0; o < added.size(); ++o) {
          sum += g[i * 10 + o] * added[o];
        }
      }
      return sum;
    };
    size_t moved = 0;
    for (size_t w = 0; w < weights.size(); w += 37) {
      constexpr double kStep = 1e-6;
      const double middle = weights[w];
      weights[w] = middle + kStep;
      const double above = loss();
      weights[w] = middle - kStep;
      const double below = loss();
      weights[w] = middle;
      const double expected = (above - below) / (2 * kStep);
      EXPECT_NEAR(got[w], expected, 2e-3 * (1 + std::abs(expected))) << "weight " << w;
      moved += std::abs(expected) > 1e-3 ? 1 : 0;
    }
    EXPECT_GT(moved, 40U);
  }
}

TEST(Adjustment, IsTheSameAtAnyNumberOfThreads) {
  const std::vector<AdjustmentInput> inputs = random_inputs(2000);
  const Adjustment model = taught(small_options(0.08f));
  std::vector<Adjusted> gradient(inputs.size(), {{1, 2, 3}, {1, 0, 1}, {0, 1, 2, 1}});
  std::vector<float> many, one;
  model.backward(inputs, gradient, many);
  set_thread_count(1);
  model.backward(inputs, gradient, one);
  set_thread_count(0);
  EXPECT_TRUE(many == one);
}

TEST(Adjustment, ActsInItsWindowAlone) {
  const Adjustment model = taught(small_options(0.08f));
  EXPECT_FLOAT_EQ(model.share(0), 1);
  EXPECT_EQ(model.share(8), 0);
  EXPECT_EQ(model.share(-20), 0);
  EXPECT_FLOAT_EQ(model.share(3), model.share(-3));
  EXPECT_GT(model.share(3), model.share(4));
  EXPECT_FLOAT_EQ(taught(small_options(0)).share(1000), 1);
}

TEST(Truncation, ShowsWhatThePlaneHasNotPassed) {
  EXPECT_TRUE(is_shown(3.1f, 3.0f));
  EXPECT_FALSE(is_shown(3.0f, 3.0f));
}

TEST(Truncation, SurrogateIsTheDerivativeOfTheSigmoid) {
  constexpr double kTau = 1.7;
  const auto sigmoid = [&](double m, double offset) {
    return 1 / (1 + std::exp(-(m - offset) / kTau));
  };
  for (const double m : {-8.0, -1.0, 0.0, 0.4, 2.0, 9.0}) {
    constexpr double kStep = 1e-5;
    const double expected = (sigmoid(m + kStep, 0.3) - sigmoid(m - kStep, 0.3)) / (2 * kStep);
    EXPECT_NEAR(straight_through(static_cast<float>(m), 0.3f, static_cast<float>(kTau)), expected,
                1e-6);
  }
}

}  // namespace
}  // namespace clipgs
