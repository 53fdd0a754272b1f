#pragma once

#include <array>
#include <optional>
#include <span>

#include "core/camera.h"
#include "core/image.h"
#include "measure/pixel_classes.h"

namespace clipgs {

// Every metric compares two pictures of one size, in display sRGB [0, 1] over a black background.
// RGBA pictures have straight alpha; a picture of 3 channels counts as opaque. The functions throw
// Error when the sizes differ.

/// Throws Error unless two pictures have one size.
void require_same_size(const Image& a, const Image& b);

/// Value reported for pictures that are equal: no infinity enters a mean or a JSON file.
constexpr double kMaxPsnr = 100.0;

/// Alpha below which the clipped truth counts as empty, for `leak`.
constexpr float kEmptyAlpha = 0.02f;
/// Half width of the band at the plane, as a share of the extent of the visible matter.
constexpr float kBandShare = 0.02f;

/// −10·log₁₀(mse), at most kMaxPsnr.
double psnr_from_mse(double mse);

/// PSNR over RGB of the whole picture, dB.
double psnr(const Image& truth, const Image& picture);

/// Squared differences of RGB, summed over pixels and channels; sums add up over pictures.
struct SquaredError {
  double sum = 0;
  size_t pixels = 0;

  void add(const SquaredError& other) {
    sum += other.sum;
    pixels += other.pixels;
  }
  /// dB; empty without pixels.
  std::optional<double> psnr() const;
};

/// Over the pixels where either alpha exceeds kMaskAlpha: no background can flatter its PSNR, the
/// masked PSNR.
SquaredError masked_error(const Image& truth, const Image& picture);

/// The same by class, in the order of kPixelClasses; `classes` are of all pixels.
using ClassErrors = std::array<SquaredError, kPixelClasses.size()>;
ClassErrors masked_errors(const Image& truth, const Image& picture,
                          std::span<const PixelClass> classes);

/// SSIM per pixel (Wang et al. 2004), mean of the three channels: [height, width, 1]. Gaussian
/// window of 11×11 pixels, σ 1.5, K1 0.01, K2 0.03, data range 1, zero padding as 3DGS.
Image ssim_map(const Image& truth, const Image& picture);

/// Mean of the SSIM map.
double ssim(const Image& truth, const Image& picture);
double mean(const Image& map);
/// Over the pixels that masked_error() counts; empty where there are none.
std::optional<double> masked_mean(const Image& map, const Image& truth, const Image& picture);

/// Mean of `ssim_map` over the pixels whose first hit lies within `half_width` mm of the plane.
/// `depth` [height, width, 1] is the truth's first-hit distance along the pixel's ray from the
/// camera, mm, 0 where nothing is hit. Empty when no pixel is in the band.
std::optional<double> band_ssim(const Image& ssim_map, const Image& depth, const Camera& camera,
                                const Plane& plane, float half_width);

/// The two energies whose ratio is the leak; both sum over pictures.
struct Leak {
  double leaked = 0;  ///< Σ of squared RGB that the picture puts where the cut left nothing
  double truth = 0;   ///< Σ of squared RGB of the clipped truth

  void add(const Leak& other) {
    leaked += other.leaked;
    truth += other.truth;
  }
  /// leaked / truth in units of 10⁻². Empty when the truth has no energy.
  std::optional<double> percent() const;
};

/// `leaked` counts the pixels where the clipped truth is empty (alpha below kEmptyAlpha) and the
/// uncut truth is not.
Leak leak(const Image& truth, const Image& uncut_truth, const Image& picture);

}  // namespace clipgs
