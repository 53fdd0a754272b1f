#pragma once

#include "splat/gaussians.h"

namespace clipgs {

/// 0.5 + Σ Yₖ(direction)·cₖ of Gaussian `i`, display sRGB, not clamped. `direction` is a unit
/// vector from the camera to the Gaussian.
Vec3 sh_color(const Gaussians& gaussians, size_t i, const Vec3& direction);

/// Chain rule through `sh_color`: writes the SH planes of `gradients` and returns ∂L/∂offset, where
/// offset = mean − camera position is not normalised.
Vec3 sh_color_backward(const Gaussians& gaussians, size_t i, const Vec3& offset,
                       const Vec3& color_gradient, Gaussians& gradients);

/// Σ Yₖ(normal)·cₖ of the face colours of Gaussian `i`, display sRGB: what a plane with that
/// normal (unit, towards the kept side) adds to the colour where it cuts the Gaussian.
Vec3 face_color(const Gaussians& gaussians, size_t i, const Vec3& normal);

/// Chain rule through `face_color`: writes the planes of face colours of `gradients`.
void face_color_backward(size_t i, const Vec3& normal, const Vec3& color_gradient,
                         Gaussians& gradients);

}  // namespace clipgs
