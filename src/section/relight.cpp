#include "section/relight.h"

#include <algorithm>

#include "core/parallel.h"

namespace clipgs {
namespace {

Vec3 shortest_axis(const Gaussians& gaussians, size_t i) {
  const Vec3 scale = gaussians.scale(i);
  const int axis = scale.x <= scale.y && scale.x <= scale.z ? 0 : (scale.y <= scale.z ? 1 : 2);
  return glm::mat3_cast(gaussians.rotation(i))[axis];
}

/// A factor of linear light as one of a colour in display sRGB.
float display_gain(float gain, float color, ToneCurve tone) {
  constexpr float kBlack = 0.001f;  // darker colours change as this one does
  const float bounded = std::clamp(color, kBlack, 1.0f);
  return display_from_linear(gain * linear_from_display(bounded, tone), tone) / bounded;
}

}  // namespace

Gaussians relit(const Gaussians& gaussians, const OpenedLight& light, ToneCurve tone) {
  Gaussians result = gaussians;
  const int coefficients = sh_coefficients(gaussians.sh_degree());
  parallel_for(gaussians.size(), 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 light_gain = light.gain(gaussians.mean(i), shortest_axis(gaussians, i));
      for (int c = 0; c < 3; ++c) {
        // Colour is ½ + Σ Yₖ·cₖ: half of it is no coefficient.
        float& constant = result.plane(Gaussians::kSh + c)[i];
        const float color = 0.5f + kShBand0 * constant;
        const float gain = display_gain(light_gain[c], color, tone);
        constant = (gain * color - 0.5f) / kShBand0;
        for (int k = 1; k < coefficients; ++k) {
          result.plane(Gaussians::kSh + 3 * k + c)[i] *= gain;
        }
      }
    }
  });
  return result;
}

}  // namespace clipgs
