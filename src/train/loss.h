#pragma once

#include <vector>

#include "core/geometry.h"
#include "core/image.h"

namespace clipgs {

/// Weights of the training loss (method.md §4): L = (1−dssim)·L1 + dssim·(1 − SSIM) on RGB over a
/// background, plus alpha·L1 on alpha.
struct LossWeights {
  float dssim = 0.2f;
  float alpha = 0.2f;
};

/// The loss of one picture and its gradient. Keeps its buffers between calls.
class ImageLoss {
 public:
  /// `predicted` [h, w, 4]: premultiplied display sRGB and alpha, as Rasterizer::forward gives it.
  /// `truth` [h, w, 4]: the same convention. Both are composited over `background` (display sRGB).
  /// Writes ∂L/∂predicted into `gradient` and returns L.
  double evaluate(const Image& predicted, const Image& truth, const Vec3& background,
                  const LossWeights& weights, Image& gradient);

 private:
  double evaluate_channel(int channel, int width, int height, const LossWeights& weights,
                          Image& gradient);
  void blur(const std::vector<float>& in, std::vector<float>& out, int width, int height);

  // One channel at a time, planar [h, w].
  std::vector<float> x_, y_;                      // predicted, truth
  std::vector<float> xx_, yy_, xy_;               // products
  std::vector<float> mx_, my_, mxx_, myy_, mxy_;  // their local means
  std::vector<float> scratch_;
  std::vector<double> row_sums_;
};

}  // namespace clipgs
