#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "splat/gaussians.h"

namespace clipgs {

/// Learning rates of the parameter groups. All but opacity's are about ten times those of 3DGS, and
/// view dependence learns half as fast as colour, not a twentieth: most Gaussians are interior,
/// seen only where a plane cuts, in one picture of a hundred; and how bright a face is depends on
/// the direction it is seen from.
struct LearningRates {
  float mean = 0;  ///< mm; the caller decays it
  float log_scale = 4e-2f;
  float rotation = 8e-3f;
  float opacity = 5e-2f;
  float sh0 = 2e-2f;
  float sh_rest = 1e-2f;
  float face = 1e-2f;
};

/// Adam over the Gaussians that reached a pixel. Others keep their moments: a Gaussian that was cut
/// away or hidden learns nothing from that picture; momentum alone must not move it, and a second
/// moment that decays over hundreds of such pictures would make its next step a leap. Bias
/// correction counts each Gaussian's own updates.
class Adam {
 public:
  static constexpr float kBeta1 = 0.9f;
  static constexpr float kBeta2 = 0.999f;
  static constexpr float kEpsilon = 1e-15f;

  /// Bias correction of an update, the `t`-th of what it moves.
  static float correction(float t) {
    return std::sqrt(1 - std::pow(kBeta2, t)) / (1 - std::pow(kBeta1, t));
  }
  /// Takes `gradient` (a number or a vector) into the moments; returns what to subtract. `rate`:
  /// corrected.
  template <typename T>
  static T advance(const T& gradient, float rate, T& first, T& second) {
    first = kBeta1 * first + (1 - kBeta1) * gradient;
    second = kBeta2 * second + (1 - kBeta2) * gradient * gradient;
    return rate * first / (glm::sqrt(second) + kEpsilon);
  }

  Adam() = default;
  /// For `gaussians` and those that are like them.
  explicit Adam(const Gaussians& gaussians)
      : first_(gaussians.like(gaussians.size())), second_(first_), updates_(gaussians.size(), 0) {}

  /// One step for the Gaussians in `reached` (indices, any order).
  void step(const std::vector<std::uint32_t>& reached, const Gaussians& gradients,
            const LearningRates& rates, Gaussians& gaussians);

  /// Forgets the history of Gaussian `i` (it was relocated).
  void reset(size_t i);
  /// Makes room for `size` Gaussians; new ones start without history.
  void resize(size_t size);

  Gaussians& first() { return first_; }
  Gaussians& second() { return second_; }
  std::vector<std::uint32_t>& updates() { return updates_; }

 private:
  Gaussians first_;  // moments, laid out as the parameters
  Gaussians second_;
  std::vector<std::uint32_t> updates_;
};

/// Copies the planes of `from` into a larger cloud; the new Gaussians' parameters are 0.
Gaussians resized(const Gaussians& from, size_t size);

}  // namespace clipgs
