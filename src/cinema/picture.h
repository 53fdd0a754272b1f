#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cinema/path_tracer.h"
#include "cinema/scene.h"
#include "core/camera.h"
#include "core/cut.h"
#include "core/depth_cue.h"
#include "core/image.h"
#include "core/tone.h"

namespace clipgs {

/// How a picture is traced.
struct PictureOptions {
  int spp = 64;        ///< most samples a pixel, as a mean over the pixels that show matter
  float noise_db = 0;  ///< stop as soon as the noise floor is this high; 0: spend all samples
  float masked_noise_db = 0;  ///< and that of the pixels that show matter this high; 0: any
  int max_bounces = 6;        ///< vertices of a path
  Lens lens;
  std::optional<Floor> floor;
  bool features = false;  ///< draw what denoise() needs
  std::uint64_t seed = 1;
  std::string progress;  ///< label of a progress line; empty: silent
};

/// What camera rays met first, as means over a half's samples.
struct Features {
  Image albedo;  ///< [height, width, 3]: linear, times alpha
  Image normal;  ///< [height, width, 3]: outward, in the grid's frame, times the share of surfaces
  Image depth;   ///< [height, width, 1]: mm from the camera, over the samples that met matter
};

/// A path-traced picture as two independent halves, each [height, width, 4]: linear radiance before
/// exposure, premultiplied by alpha, and alpha. Their mean is the picture; their difference tells
/// its noise.
struct Picture {
  Image half_a;
  Image half_b;
  Features features_a, features_b;  ///< empty unless asked for
  double samples = 0;               ///< paths traced in all

  /// Mean of the halves: linear premultiplied RGBA.
  Image mean() const;
  /// Mean distance from the camera of what its rays met first, mm; 0 where they met nothing. A
  /// floor counts as at the camera. [height, width, 1]; needs the features.
  Image depth() const;
};

/// Renders what `camera` sees of what `cut` keeps of the scene. Samples go where the noise is; the
/// picture is a function of its inputs alone, whatever the number of threads.
Picture render_picture(const CinemaScene& scene, const Camera& camera, const Cut& cut,
                       const PictureOptions& options);

/// First-hit depth: distance from the camera in mm along each pixel's central ray at which it meets
/// matter (median over what it meets), 0 for background. [height, width, 1].
Image render_depth(const CinemaScene& scene, const Camera& camera, const Cut& cut);

/// As displayed: straight-alpha sRGB RGBA in [0, 1]. The colour is what the matter in a pixel looks
/// like by itself, sRGB(tone(exposure · radiance / alpha)); alpha then blends it in display space,
/// as every viewer of PNGs and every splat renderer does. Opaque pixels show
/// sRGB(tone(exposure · radiance)) exactly.
Image display(const Image& premultiplied, const DisplayTransform& transform);

/// Takes off a displayed picture's alpha what a depth cue takes off matter at these distances (mm,
/// [height, width, 1]): over any background it then fades towards that.
void fade(Image& straight, const Image& depth, const DepthCue& cue);

/// Noise floor of the displayed picture over a background of this grey, in dB: −10·log10(MSE(A,
/// B)/4), for the error of the mean of two halves with independent errors is a quarter of their
/// mean squared difference. No PSNR against the picture can be trusted above it. At most kNoNoise.
float noise_floor(const Picture& picture, const DisplayTransform& transform, float background = 0);

/// The same over black, of the pixels alone that a masked PSNR counts: alpha above kMaskAlpha.
float masked_noise_floor(const Picture& picture, const DisplayTransform& transform);

constexpr float kNoNoise = 99;

}  // namespace clipgs
