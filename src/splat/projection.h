#pragma once

#include <cstdint>
#include <span>

#include "core/camera.h"
#include "core/cut.h"
#include "core/depth_cue.h"
#include "splat/face_gain.h"
#include "splat/gaussians.h"
#include "splat/layer_switch.h"
#include "splat/render.h"

namespace clipgs {

/// Thresholds of the rasteriser. Gradient tests widen them, because the steps that they make are
/// not differentiable; everything else uses the defaults, which the viewer's shaders share.
struct RasterOptions {
  ClipOperator clip = ClipOperator::kExact;
  float alpha_min = 1.0f / 255.0f;  ///< fainter contributions are skipped
  float alpha_max = 0.99f;          ///< opacity of one Gaussian at one pixel is clamped to this
  float transmittance_min = 1e-4f;  ///< a pixel darker than this is finished
  float clip_sigma = 3.0f;          ///< exact: Gaussians further from the plane are not cut
  FaceGain face_gain;               ///< of the Gaussians that are drawn
  LayerSwitch layers;               ///< the same
  DepthCue cue;                     ///< of their colours: they fade to black; not trained with
  bool kept_share = false;          ///< exact: planes seen along themselves end all, see KeptShare
};

/// A plane, and the gain of the splats at its face.
struct LitPlane : Plane {
  Vec3 gain{1};
};

/// Variance added to every projected Gaussian, px²: about that of a pixel's own area, 1/12, as in
/// Mip-Splatting (Yu 2024). 3DGS's 0.3 blurs outlines over twice their true width.
constexpr float kBlurVariance = 0.1f;
/// Gaussians nearer to the camera than this are not drawn, mm.
constexpr float kNearPlane = 1.0f;

/// A Gaussian on the image plane: all that a pixel needs. 64 bytes, one cache line.
/// With δ = pixel − center: α(δ) = min(alpha_max, opacity · Φ(z) · exp(qa·δx² + qb·δxδy + qc·δy²)),
/// z = z0 + zx·δx + zy·δy, where Φ(z) is there only for `clipped` ones. What more planes than one
/// leave of a Gaussian is the product of their Φ, or Φ₁ + Φ₂ − 1 of opposite ones.
struct alignas(64) Splat {
  float x, y;                ///< projected centre, px
  float qa, qb, qc;          ///< −½·Σ₂⁻¹ with the off-diagonal doubled
  float opacity;             ///< with the factor of the soft operator
  float r, g, b;             ///< display sRGB ≥ 0
  float z0, zx, zy;          ///< exact operator: standardised plane distance and its slope per px
  float extent_x, extent_y;  ///< half size of the box where α ≥ alpha_min, px
  float depth;               ///< camera z, mm
  std::uint32_t clipped;     ///< planes that cut it: 0 none, 1 this one, more: see PlaneCut
};

/// One more plane that cuts a Gaussian.
struct PlaneCut {
  float z0, zx, zy;
  bool opposite;  ///< to the one before
};

/// Gradient of a loss with respect to the numbers of one Splat, as moments over pixels: with
/// h = ∂L/∂α·α and e = ∂L/∂z summed over pixels.
struct SplatGradient {
  float h, hx, hy, hxx, hxy, hyy;  ///< Σh, Σhδx, Σhδy, Σhδx², Σhδxδy, Σhδy²
  float r, g, b;                   ///< ∂L/∂colour
  float e, ex, ey;                 ///< Σe, Σeδx, Σeδy
};

/// Projects Gaussian `i`; false if it is invisible (behind the camera, outside the frame, cut away,
/// or too faint). `more` has room for all planes but one: what the exact operator does with the
/// second and further planes that cut it.
bool project(const Gaussians& gaussians, size_t i, const Camera& camera,
             std::span<const LitPlane> planes, const RasterOptions& options, Splat& splat,
             PlaneCut* more);

/// Chain rule through `project` for one plane or none: writes ∂L/∂parameter of Gaussian `i` into
/// every plane of `gradients`, and returns ∂L/∂gain of the plane. `splat` is what `project`
/// returned for it.
Vec3 project_backward(const Gaussians& gaussians, size_t i, const Camera& camera,
                      std::span<const LitPlane> planes, const RasterOptions& options,
                      const Splat& splat, const SplatGradient& gradient, Gaussians& gradients);

}  // namespace clipgs
