#pragma once

namespace clipgs {

// Constants of the exact clip operator, shared with the shaders (method.md §3).

/// Beyond this many standard deviations from the plane a Gaussian counts as wholly kept or removed.
constexpr float kClipSigma = 3.0f;

/// Φ(x) ≈ 1 / (1 + exp(−(kCdfLinear·x + kCdfCubic·x³))), error below 1.5e-4.
constexpr float kCdfLinear = 1.5976f;
constexpr float kCdfCubic = 0.07056f;

/// The conditional variance of the plane distance is kept above this share of its variance.
constexpr float kMinConditionalVariance = 1e-6f;

}  // namespace clipgs
