#include "core/random.h"

#include <cmath>
#include <numbers>

namespace clipgs {

float Rng::normal() {
  const float u = 1.0f - uniform();  // (0, 1]
  const float v = uniform();
  return std::sqrt(-2.0f * std::log(u)) * std::cos(2.0f * std::numbers::pi_v<float> * v);
}

}  // namespace clipgs
