#pragma once

#include "splat/gaussians.h"

namespace clipgs {

// What Gaussians cost whoever blends them: fragments a pixel. One that is seen along one of its own
// axes is blended within the ellipse where α ≥ 1/255, whose area is π·2 ln(255·opacity)·s₁s₂ by the
// deviations along the other two. The mean over the three axes stands for any direction; what is in
// front of it does not count, nor what a cut takes away.

/// Fragments a pixel of a disc of `radius` (mm), that of the scene's sphere, from all of
/// `gaussians`.
double overdraw(const Gaussians& gaussians, float radius);

/// ∫α over the picture of Gaussian `i`, seen in the same way: the area (mm²) that it covers as if
/// opaque.
float mean_cover(const Gaussians& gaussians, size_t i);

/// Adds `weight` times the gradient of overdraw() to `gradients`, for Gaussian `i`.
void add_overdraw_gradient(const Gaussians& gaussians, size_t i, float radius, float weight,
                           Gaussians& gradients);

}  // namespace clipgs
