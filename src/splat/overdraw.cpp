#include "splat/overdraw.h"

#include <algorithm>
#include <cmath>

#include "core/geometry.h"
#include "splat/projection.h"

namespace clipgs {

namespace {

/// Squared standard deviations to the edge of what is blended; 0 where nothing is.
float squared_reach(float opacity) {
  return 2 * std::log(std::max(opacity / RasterOptions().alpha_min, 1.0f));
}

/// s₁s₂ + s₂s₃ + s₃s₁, mm².
float summed_products(const Vec3& s) { return s.x * s.y + s.y * s.z + s.z * s.x; }

}  // namespace

double overdraw(const Gaussians& gaussians, float radius) {
  double sum = 0;
  for (size_t i = 0; i < gaussians.size(); ++i) {
    sum += squared_reach(gaussians.opacity(i)) * summed_products(gaussians.scale(i));
  }
  return sum / (3 * double{radius} * radius);
}

float mean_cover(const Gaussians& gaussians, size_t i) {
  return 2 * kPi / 3 * gaussians.opacity(i) * summed_products(gaussians.scale(i));
}

void add_overdraw_gradient(const Gaussians& gaussians, size_t i, float radius, float weight,
                           Gaussians& gradients) {
  const float opacity = gaussians.opacity(i);
  const float reach2 = squared_reach(opacity);
  if (reach2 == 0) {
    return;
  }
  const Vec3 s = gaussians.scale(i);
  const Vec3 products(s.y * s.z, s.z * s.x, s.x * s.y);
  const float sum = summed_products(s);
  const float scale = weight / (3 * radius * radius);
  for (int a = 0; a < 3; ++a) {
    gradients.plane(Gaussians::kLogScale + a)[i] += scale * reach2 * (sum - products[a]);
  }
  // ∂(2 ln o)/∂logit = 2(1 − o)
  gradients.plane(Gaussians::kOpacity)[i] += scale * 2 * (1 - opacity) * sum;
}

}  // namespace clipgs
