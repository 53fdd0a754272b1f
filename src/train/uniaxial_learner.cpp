#include "train/uniaxial_learner.h"

#include <algorithm>
#include <cmath>

#include "train/adam.h"

namespace clipgs {

namespace {

/// Temperatures away from the plane beyond which a threshold stays as it is: the sigmoid is flat
/// there, but Adam would make whole steps of its last digits.
constexpr float kFlat = 8;

/// The options as numbers, so that a checkpoint of others is told.
std::vector<float> numbers_of(const UniaxialOptions& options) {
  return {static_cast<float>(options.truncation), options.adjust ? 1.0f : 0.0f,
          options.coarse_share, options.adjustment.window, options.adjustment.shape ? 1.0f : 0.0f};
}

}  // namespace

void UniaxialLearner::Moments::resize(size_t size) {
  first.resize(size, 0.0f);
  second.resize(size, 0.0f);
  updates.resize(size, 0.0f);
}

void UniaxialLearner::Moments::reset(size_t i) { first[i] = second[i] = updates[i] = 0; }

float UniaxialLearner::Moments::move(size_t i, float gradient, float rate) {
  const float corrected = rate * Adam::correction(++updates[i]);
  return -Adam::advance(gradient, corrected, first[i], second[i]);
}

UniaxialLearner::UniaxialLearner(const UniaxialOptions& options, const Vec3& normal,
                                 const Sphere& sphere, float extent, const Gaussians& gaussians,
                                 std::uint64_t seed)
    : options_(options) {
  parameters_.normal = normal;
  parameters_.truncation = options.truncation;
  parameters_.temperature = kTruncationTemperature * extent;
  beyond_center_.assign(gaussians.size(), 0.0f);
  place_thresholds(gaussians);
  threshold_moments_.resize(gaussians.size());
  if (options.adjust) {
    waiting_.emplace(options.adjustment, sphere, extent, seed);
    weight_moments_.resize(waiting_->weights().size());
  }
}

void UniaxialLearner::place_thresholds(const Gaussians& gaussians) {
  parameters_.thresholds.resize(gaussians.size());
  for (size_t i = 0; i < gaussians.size(); ++i) {
    parameters_.thresholds[i] = glm::dot(parameters_.normal, gaussians.mean(i)) + beyond_center_[i];
  }
}

const Gaussians& UniaxialLearner::forward(const Gaussians& gaussians, std::optional<float> offset) {
  offset_ = offset;
  place_thresholds(gaussians);
  make_state(gaussians, parameters_, offset, state_);
  return state_.gaussians;
}

void UniaxialLearner::backward(Rasterizer& rasterizer, const Image& image_gradient,
                               Gaussians& gradients) {
  if (state_gradients_.size() != state_.gaussians.size()) {
    state_gradients_ = state_.gaussians.like(state_.gaussians.size());
  }
  rasterizer.backward(state_.gaussians, image_gradient, state_gradients_);
  reached_ = rasterizer.reached();
  state_backward(parameters_, offset_, state_, state_gradients_, reached_, gradients, gradients_);
}

void UniaxialLearner::step(float decay) {
  if (offset_ && parameters_.truncation == Truncation::kLearned) {
    const float rate = decay * kThresholdRate * parameters_.temperature;
    for (const std::uint32_t i : reached_) {
      if (std::abs(parameters_.thresholds[i] - *offset_) < kFlat * parameters_.temperature) {
        beyond_center_[i] += threshold_moments_.move(i, gradients_.thresholds[i], rate);
      }
    }
  }
  for (size_t w = 0; w < gradients_.weights.size(); ++w) {
    parameters_.adjustment->weights()[w] +=
        weight_moments_.move(w, gradients_.weights[w], decay * kWeightRate);
  }
}

void UniaxialLearner::start_adjusting() {
  if (waiting_) {
    parameters_.adjustment = std::move(waiting_);
    waiting_.reset();
  }
}

void UniaxialLearner::copied(const std::vector<std::uint32_t>& targets,
                             const std::vector<std::uint32_t>& sources) {
  for (size_t k = 0; k < targets.size(); ++k) {
    const std::uint32_t target = targets[k];
    if (target >= beyond_center_.size()) {
      beyond_center_.resize(target + 1);
      threshold_moments_.resize(target + 1);
    }
    beyond_center_[target] = beyond_center_[sources[k]];
    threshold_moments_.reset(target);
  }
}

std::vector<float> UniaxialLearner::save() const {
  const std::optional<Adjustment>& adjustment = waiting_ ? waiting_ : parameters_.adjustment;
  std::vector<float> numbers = numbers_of(options_);
  numbers.push_back(waiting_ ? 0.0f : 1.0f);
  const auto append = [&](const std::vector<float>& list) {
    numbers.insert(numbers.end(), list.begin(), list.end());
  };
  append(beyond_center_);
  if (adjustment) {
    append(adjustment->weights());
  }
  for (const Moments* moments : {&threshold_moments_, &weight_moments_}) {
    append(moments->first);
    append(moments->second);
    append(moments->updates);
  }
  return numbers;
}

bool UniaxialLearner::load(const std::vector<float>& numbers, size_t size) {
  const size_t weights = weight_moments_.first.size();
  const std::vector<float> options = numbers_of(options_);
  if (numbers.size() != options.size() + 1 + 4 * (size + weights) ||
      !std::equal(options.begin(), options.end(), numbers.begin())) {
    return false;
  }
  const float* at = numbers.data() + options.size();
  if (*at++ == 1.0f) {
    start_adjusting();
  }
  const auto take = [&](std::vector<float>& list, size_t count) {
    list.assign(at, at + count);
    at += count;
  };
  take(beyond_center_, size);
  if (weights > 0) {
    take((waiting_ ? waiting_ : parameters_.adjustment)->weights(), weights);
  }
  for (const auto& [moments, count] :
       {std::pair{&threshold_moments_, size}, {&weight_moments_, weights}}) {
    take(moments->first, count);
    take(moments->second, count);
    take(moments->updates, count);
  }
  return true;
}

}  // namespace clipgs
