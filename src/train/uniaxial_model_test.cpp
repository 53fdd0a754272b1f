#include "train/uniaxial_model.h"

#include <algorithm>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "core/random.h"
#include "splat/rasterizer.h"
#include "splat/reference.h"
#include "splat/test_scene.h"
#include "train/model_file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

constexpr float kOffset = 2;  // of the plane, mm
const Sphere kBall{Vec3(0), 30};
constexpr float kBallExtent = 60;
constexpr float kWindow = 0.15f;

AdjustmentOptions small_options() {
  AdjustmentOptions options;
  options.position_octaves = 2;
  options.plane_octaves = 2;
  options.width = 16;
  options.hidden_layers = 1;
  options.window = kWindow;
  return options;
}

/// An adjustment that does something.
Adjustment random_adjustment() {
  Adjustment adjustment(small_options(), kBall, kBallExtent, 3);
  Rng rng(8);
  std::vector<float>& weights = adjustment.weights();
  for (size_t w = weights.size() - 16 * 17; w < weights.size() - 16 - 6 * 16; ++w) {
    weights[w] = 0.1f * rng.normal();  // ten outputs of sixteen neurons
  }
  return adjustment;
}

Gaussians small_cloud() {
  Gaussians cloud = random_gaussians(24, 1, 5, Vec3(0), 16);
  for (size_t i = 0; i < cloud.size(); ++i) {
    for (int a = 0; a < 3; ++a) {
      cloud.plane(Gaussians::kLogScale + a)[i] += 1;
    }
  }
  return cloud;
}

UniaxialParameters parameters_of(const Gaussians& cloud, Truncation truncation) {
  UniaxialParameters parameters;
  parameters.normal = Vec3(0, 0.6f, 0.8f);
  parameters.truncation = truncation;
  parameters.temperature = 3;
  Rng rng(6);
  for (size_t i = 0; i < cloud.size(); ++i) {
    parameters.thresholds.push_back(glm::dot(parameters.normal, cloud.mean(i)) + 4 * rng.normal());
  }
  parameters.adjustment = random_adjustment();
  return parameters;
}

TEST(UniaxialState, EachTruncationShowsItsOwn) {
  const Gaussians cloud = small_cloud();
  UniaxialState state;
  for (const Truncation truncation : {Truncation::kNone, Truncation::kHard, Truncation::kLearned}) {
    const UniaxialParameters parameters = parameters_of(cloud, truncation);
    make_state(cloud, parameters, kOffset, state);
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      const float m = truncation == Truncation::kHard ? glm::dot(parameters.normal, cloud.mean(i))
                                                      : parameters.thresholds[i];
      EXPECT_EQ(std::ranges::binary_search(state.ids, i),
                truncation == Truncation::kNone || m > kOffset);
    }
    make_state(cloud, parameters, std::nullopt, state);
    EXPECT_EQ(state.gaussians.data(), cloud.data());  // uncut
  }
}

TEST(UniaxialState, AdjustsNearThePlaneAndLeavesColourAndOpacity) {
  const Gaussians cloud = small_cloud();
  const UniaxialParameters parameters = parameters_of(cloud, Truncation::kHard);
  UniaxialState state;
  make_state(cloud, parameters, kOffset, state);
  size_t moved = 0;
  for (size_t k = 0; k < state.ids.size(); ++k) {
    const std::uint32_t i = state.ids[k];
    const float d = glm::dot(parameters.normal, cloud.mean(i)) - kOffset;
    const bool changed = state.gaussians.mean(k) != cloud.mean(i);
    EXPECT_EQ(changed, d < kWindow * kBallExtent) << d;
    moved += changed ? 1 : 0;
    for (int p = Gaussians::kOpacity; p < cloud.planes(); ++p) {
      EXPECT_EQ(state.gaussians.plane(p)[k], cloud.plane(p)[i]);
    }
  }
  EXPECT_GT(moved, 4U);
  EXPECT_LT(moved, state.ids.size());
}

/// A loss of the state's picture, by the fast way and by the slow one.
class UniaxialGradientsTest : public testing::Test {
 protected:
  UniaxialGradientsTest() {
    // No step to differentiate across but the truncation's.
    raster_.alpha_min = 1e-7f;
    raster_.alpha_max = 0.9999f;
    raster_.transmittance_min = 0;
    Rng rng(4);
    for (float& w : weight_.data) {
      w = rng.uniform() - 0.3f;
    }
    UniaxialState state;
    make_state(cloud_, parameters_, kOffset, state);
    Rasterizer rasterizer;
    rasterizer.forward(state.gaussians, camera_, std::nullopt, raster_);
    Gaussians state_gradients(state.gaussians.size(), 1);
    rasterizer.backward(state.gaussians, weight_, state_gradients);
    reached_ = rasterizer.reached();
    state_backward(parameters_, kOffset, state, state_gradients, reached_, gradients_, uniaxial_);
    state_ = state;
    for (const float w : parameters_.adjustment->weights()) {
      weights_.push_back(w);
    }
    values_.assign(cloud_.data().begin(), cloud_.data().end());
  }

  /// Written down anew: what is shown, adjusted by the reference. What the adjustment sees stays as
  /// it was: it counts as constant. `shares` multiplies opacities, as M does.
  double loss() const {
    const size_t n = state_.ids.size();
    const auto planes = static_cast<size_t>(cloud_.planes());
    std::vector<double> shown(n * planes);
    for (size_t k = 0; k < n; ++k) {
      for (size_t p = 0; p < planes; ++p) {
        shown[p * n + k] = values_[p * cloud_.size() + state_.ids[k]];
      }
      const double logit = shown[Gaussians::kOpacity * n + k];
      const double opacity = shares_[state_.ids[k]] / (1 + std::exp(-logit));
      shown[Gaussians::kOpacity * n + k] = std::log(opacity / (1 - opacity));
    }
    for (size_t a = 0; a < state_.adjusted.size(); ++a) {
      const std::vector<double> added =
          reference_adjustment(small_options(), kBall, kBallExtent, weights_, state_.inputs[a]);
      for (size_t p = 0; p < added.size(); ++p) {  // mean, log-scales, rotation: planes 0 to 9
        shown[p * n + state_.adjusted[a]] += added[p];
      }
    }
    const std::vector<double> image =
        reference_render(shown, state_.gaussians, camera_, std::nullopt, raster_);
    double sum = 0;
    for (size_t i = 0; i < image.size(); ++i) {
      sum += image[i] * weight_.data[i];
    }
    return sum;
  }

  double derivative(double& value) const {
    constexpr double kStep = 1e-5;
    const double middle = value;
    value = middle + kStep;
    const double above = loss();
    value = middle - kStep;
    const double below = loss();
    value = middle;
    return (above - below) / (2 * kStep);
  }

  const Gaussians cloud_ = small_cloud();
  const UniaxialParameters parameters_ = parameters_of(cloud_, Truncation::kLearned);
  const Camera camera_ = frame_sphere(kBall, View{20, 30, 1}, 40, 36);
  RasterOptions raster_;
  Image weight_{40, 36, 4};
  UniaxialState state_;
  std::vector<std::uint32_t> reached_;
  Gaussians gradients_{24, 1};
  UniaxialGradients uniaxial_;
  std::vector<double> values_;
  std::vector<double> weights_;
  std::vector<double> shares_ = std::vector<double>(24, 1.0);
};

TEST_F(UniaxialGradientsTest, OfTheGaussiansAreFiniteDifferences) {
  ASSERT_GT(reached_.size(), 8U);
  for (int p = 0; p < cloud_.planes(); ++p) {
    for (const std::uint32_t i : reached_) {
      const double expected = derivative(values_[static_cast<size_t>(p) * cloud_.size() + i]);
      EXPECT_NEAR(gradients_.plane(p)[i], expected, 1e-3 * (1 + std::abs(expected)))
          << "plane " << p << " of " << i;
    }
  }
}

TEST_F(UniaxialGradientsTest, OfTheWeightsAreFiniteDifferences) {
  ASSERT_EQ(uniaxial_.weights.size(), weights_.size());
  size_t some = 0;
  for (size_t w = 0; w < weights_.size(); w += 11) {
    const double expected = derivative(weights_[w]);
    EXPECT_NEAR(uniaxial_.weights[w], expected, 2e-3 * (1 + std::abs(expected))) << w;
    some += std::abs(expected) > 0.1 ? 1 : 0;
  }
  EXPECT_GT(some, 20U);
}

TEST_F(UniaxialGradientsTest, OfTheThresholdsAreTheSurrogateExactly) {
  for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
    if (!std::ranges::binary_search(reached_, i)) {
      EXPECT_EQ(uniaxial_.thresholds[i], 0);
      continue;
    }
    const double of_mask = derivative(shares_[i]);
    const float m = parameters_.thresholds[i];
    const double s = 1 / (1 + std::exp(-(double{m} - kOffset) / parameters_.temperature));
    const double expected = of_mask * s * (1 - s) / parameters_.temperature;
    EXPECT_NEAR(uniaxial_.thresholds[i], expected, 2e-3 * (std::abs(expected) + 1e-2));
  }
}

TEST(ModelFile, RoundTripKeepsWhatIsLearnt) {
  const fs::path path =
      fs::path(testing::TempDir()) / ("clipgs-model-" + std::to_string(getpid()) + ".ply");
  UniaxialModel written{random_scene(24, 1, 5), {}};
  written.parameters = parameters_of(written.scene.gaussians, Truncation::kLearned);
  written.parameters.adjustment.emplace(small_options(), written.scene.sphere,
                                        written.scene.extent.y - written.scene.extent.x, 3);
  write_model(path, written);
  EXPECT_TRUE(is_model(path));
  const UniaxialModel read = read_model(path);
  EXPECT_EQ(read.parameters.thresholds, written.parameters.thresholds);
  EXPECT_EQ(read.parameters.normal, written.parameters.normal);
  EXPECT_EQ(read.parameters.temperature, written.parameters.temperature);
  EXPECT_EQ(read.parameters.truncation, Truncation::kLearned);
  ASSERT_TRUE(read.parameters.adjustment);
  EXPECT_EQ(read.parameters.adjustment->options(), small_options());
  EXPECT_EQ(read.parameters.adjustment->weights(), written.parameters.adjustment->weights());

  written.parameters.adjustment.reset();
  write_model(path, written);
  EXPECT_FALSE(read_model(path).parameters.adjustment);

  const fs::path sidecar = fs::path(path).replace_extension(".json");
  std::string text = read_text(sidecar);
  const size_t version = text.find("\"version\"", text.find("\"model\""));
  text.replace(text.find('1', version), 1, "7");
  write_text(sidecar, text);
  EXPECT_THAT([&] { read_model(path); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("clipgs train --model clipgs")));
  fs::remove(path);
  fs::remove(sidecar);
}

}  // namespace
}  // namespace clipgs
