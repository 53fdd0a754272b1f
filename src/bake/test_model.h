#pragma once

#include "core/random.h"
#include "splat/test_scene.h"
#include "train/uniaxial_model.h"

namespace clipgs::test {

/// A uniaxial model of random Gaussians, thresholds and adjustments. What it adjusts moves by
/// several millimetres: from slab to slab. `window` as AdjustmentOptions::window.
inline UniaxialModel random_model(size_t count, int sh_degree, float window,
                                  bool keeps_below = true) {
  UniaxialModel model;
  model.scene = random_scene(count, sh_degree, 40);
  const Scene& scene = model.scene;
  UniaxialParameters& parameters = model.parameters;
  parameters.normal = keeps_below ? -scene.axis : scene.axis;
  parameters.temperature = 2;
  Rng rng(41);
  for (size_t i = 0; i < count; ++i) {
    // Some so far off that no state shows the Gaussian.
    const float offset = (i % 10 == 0 ? 150.0f : 5.0f) * rng.normal();
    parameters.thresholds.push_back(glm::dot(parameters.normal, scene.gaussians.mean(i)) + offset);
  }
  AdjustmentOptions options;
  options.width = 32;
  options.hidden_layers = 2;
  options.window = window;
  options.shape = false;
  Adjustment adjustment(options, scene.sphere, scene.extent.y - scene.extent.x, 42);
  // The output layer as well, which starts at 0; it is the last, of 16 rounded outputs.
  std::vector<float>& weights = adjustment.weights();
  for (size_t i = weights.size() - 16 * (32 + 1); i < weights.size(); ++i) {
    weights[i] = rng.normal();
  }
  parameters.adjustment = adjustment;
  return model;
}

}  // namespace clipgs::test
