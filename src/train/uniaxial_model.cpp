#include "train/uniaxial_model.h"

#include <algorithm>

#include "core/parallel.h"

namespace clipgs {

namespace {

constexpr size_t kModelGrain = 4096;

bool shows(const UniaxialParameters& parameters, const Gaussians& gaussians, size_t i,
           float offset) {
  switch (parameters.truncation) {
    case Truncation::kNone:
      return true;
    case Truncation::kHard:
      return is_shown(glm::dot(parameters.normal, gaussians.mean(i)), offset);
    case Truncation::kLearned:
      return is_shown(parameters.thresholds[i], offset);
  }
  return true;
}

void gather_into(const Gaussians& from, const std::vector<std::uint32_t>& ids, Gaussians& to) {
  if (to.size() != ids.size() || !to.is_like(from)) {
    to = from.like(ids.size());
  }
  parallel_for(ids.size(), kModelGrain, [&](size_t begin, size_t end) {
    for (int p = 0; p < from.planes(); ++p) {
      const float* in = from.plane(p);
      float* out = to.plane(p);
      for (size_t k = begin; k < end; ++k) {
        out[k] = in[ids[k]];
      }
    }
  });
}

/// Adds what the adjustment says to the Gaussians near the plane.
void adjust(const UniaxialParameters& parameters, float offset, UniaxialState& state) {
  const Adjustment& adjustment = *parameters.adjustment;
  Gaussians& gaussians = state.gaussians;
  for (size_t k = 0; k < gaussians.size(); ++k) {
    const Vec3 center = gaussians.mean(k);
    const float distance = glm::dot(parameters.normal, center) - offset;
    if (adjustment.share(distance) > 0) {
      const Vec3 own = parameters.normal * glm::mat3_cast(gaussians.rotation(k));
      const Vec3 log_scale(gaussians.plane(Gaussians::kLogScale)[k],
                           gaussians.plane(Gaussians::kLogScale + 1)[k],
                           gaussians.plane(Gaussians::kLogScale + 2)[k]);
      state.adjusted.push_back(static_cast<std::uint32_t>(k));
      state.inputs.push_back({center, distance, log_scale, own * own});
    }
  }
  std::vector<Adjusted> added(state.adjusted.size());
  adjustment.forward(state.inputs, added);
  for (size_t n = 0; n < added.size(); ++n) {
    const std::uint32_t k = state.adjusted[n];
    for (int a = 0; a < 3; ++a) {
      gaussians.plane(Gaussians::kMean + a)[k] += added[n].mean[a];
      gaussians.plane(Gaussians::kLogScale + a)[k] += added[n].log_scale[a];
    }
    for (int a = 0; a < 4; ++a) {
      gaussians.plane(Gaussians::kRotation + a)[k] += added[n].rotation[a];
    }
  }
}

/// ∂L/∂added of what `adjust` added.
std::vector<Adjusted> added_gradients(const UniaxialState& state, const Gaussians& gradients,
                                      const std::vector<std::uint32_t>& reached) {
  std::vector<std::uint8_t> has_gradient(state.gaussians.size(), 0);
  for (const std::uint32_t k : reached) {
    has_gradient[k] = 1;
  }
  std::vector<Adjusted> result(state.adjusted.size(), Adjusted{});
  for (size_t n = 0; n < result.size(); ++n) {
    const std::uint32_t k = state.adjusted[n];
    if (has_gradient[k] == 0) {
      continue;
    }
    for (int a = 0; a < 3; ++a) {
      result[n].mean[a] = gradients.plane(Gaussians::kMean + a)[k];
      result[n].log_scale[a] = gradients.plane(Gaussians::kLogScale + a)[k];
    }
    for (int a = 0; a < 4; ++a) {
      result[n].rotation[a] = gradients.plane(Gaussians::kRotation + a)[k];
    }
  }
  return result;
}

}  // namespace

void make_state(const Gaussians& gaussians, const UniaxialParameters& parameters,
                std::optional<float> offset, UniaxialState& state) {
  state.ids.clear();
  state.adjusted.clear();
  state.inputs.clear();
  for (size_t i = 0; i < gaussians.size(); ++i) {
    if (!offset || shows(parameters, gaussians, i, *offset)) {
      state.ids.push_back(static_cast<std::uint32_t>(i));
    }
  }
  gather_into(gaussians, state.ids, state.gaussians);
  if (offset && parameters.adjustment) {
    adjust(parameters, *offset, state);
  }
}

void state_backward(const UniaxialParameters& parameters, std::optional<float> offset,
                    const UniaxialState& state, const Gaussians& state_gradients,
                    std::vector<std::uint32_t>& reached, Gaussians& gradients,
                    UniaxialGradients& uniaxial) {
  uniaxial.weights.clear();
  if (!state.adjusted.empty()) {
    parameters.adjustment->backward(state.inputs, added_gradients(state, state_gradients, reached),
                                    uniaxial.weights);
  }
  uniaxial.thresholds.assign(parameters.thresholds.size(), 0.0f);
  const bool learns = offset && parameters.truncation == Truncation::kLearned;
  parallel_for(reached.size(), kModelGrain, [&](size_t begin, size_t end) {
    for (int p = 0; p < gradients.planes(); ++p) {
      const float* in = state_gradients.plane(p);
      float* out = gradients.plane(p);
      for (size_t n = begin; n < end; ++n) {
        out[state.ids[reached[n]]] = in[reached[n]];
      }
    }
    for (size_t n = begin; learns && n < end; ++n) {
      const std::uint32_t k = reached[n];
      // α' = M·α with M = 1: ∂L/∂M = ∂L/∂α'·α, and ∂α/∂logit = α(1 − α).
      const float of_mask = state_gradients.plane(Gaussians::kOpacity)[k] /
                            std::max(1e-6f, 1 - state.gaussians.opacity(k));
      const std::uint32_t i = state.ids[k];
      uniaxial.thresholds[i] =
          of_mask * straight_through(parameters.thresholds[i], *offset, parameters.temperature);
    }
  });
  for (std::uint32_t& k : reached) {
    k = state.ids[k];
  }
}

}  // namespace clipgs
