#include "train/loss.h"

#include <array>
#include <cmath>

#include "core/parallel.h"

namespace clipgs {

namespace {

constexpr int kRadius = 5;  // 11 taps
constexpr float kC1 = 0.01f * 0.01f;
constexpr float kC2 = 0.03f * 0.03f;
constexpr size_t kRowGrain = 16;

std::array<float, 2 * kRadius + 1> gaussian_window() {
  std::array<float, 2 * kRadius + 1> w{};
  float sum = 0;
  for (int k = -kRadius; k <= kRadius; ++k) {
    w[k + kRadius] = std::exp(-static_cast<float>(k * k) / (2 * 1.5f * 1.5f));
    sum += w[k + kRadius];
  }
  for (float& v : w) {
    v /= sum;
  }
  return w;
}

const std::array<float, 2 * kRadius + 1> kWindow = gaussian_window();

}  // namespace

void ImageLoss::blur(const std::vector<float>& in, std::vector<float>& out, int width, int height) {
  // Horizontal, with rows padded by zeros so that the inner loop has no branch; then vertical.
  scratch_.resize(static_cast<size_t>(width) * height);
  parallel_for(height, kRowGrain, [&](size_t begin, size_t end) {
    std::vector<float> padded(width + 2 * kRadius, 0.0f);
    for (size_t row = begin; row < end; ++row) {
      std::copy_n(&in[row * width], width, padded.data() + kRadius);
      float* to = &scratch_[row * width];
      std::fill_n(to, width, 0.0f);
      for (int k = 0; k <= 2 * kRadius; ++k) {
        const float w = kWindow[k];
        const float* from = padded.data() + k;
        for (int x = 0; x < width; ++x) {
          to[x] += w * from[x];
        }
      }
    }
  });
  parallel_for(height, kRowGrain, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      float* to = &out[row * width];
      std::fill_n(to, width, 0.0f);
      for (int k = -kRadius; k <= kRadius; ++k) {
        const int source = static_cast<int>(row) + k;
        if (source < 0 || source >= height) {
          continue;
        }
        const float w = kWindow[k + kRadius];
        const float* from = &scratch_[static_cast<size_t>(source) * width];
        for (int x = 0; x < width; ++x) {
          to[x] += w * from[x];
        }
      }
    }
  });
}

double ImageLoss::evaluate_channel(int channel, int width, int height, const LossWeights& weights,
                                   Image& gradient) {
  const size_t n = static_cast<size_t>(width) * height;
  parallel_for(n, kRowGrain * width, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      xx_[i] = x_[i] * x_[i];
      yy_[i] = y_[i] * y_[i];
      xy_[i] = x_[i] * y_[i];
    }
  });
  blur(x_, mx_, width, height);
  blur(y_, my_, width, height);
  blur(xx_, mxx_, width, height);
  blur(yy_, myy_, width, height);
  blur(xy_, mxy_, width, height);

  // SSIM = A1·A2 / (B1·B2); its partial derivatives by μx, E[x²], E[xy] replace mx, mxx, mxy.
  parallel_for(height, kRowGrain, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      double sum = 0;
      for (size_t i = row * width; i < (row + 1) * width; ++i) {
        const float mx = mx_[i], my = my_[i];
        const float a1 = 2 * mx * my + kC1;
        const float a2 = 2 * (mxy_[i] - mx * my) + kC2;
        const float b1 = mx * mx + my * my + kC1;
        const float b2 = (mxx_[i] - mx * mx) + (myy_[i] - my * my) + kC2;
        const float inverse = 1 / (b1 * b2);
        const float ssim = a1 * a2 * inverse;
        sum += ssim;
        mx_[i] = 2 * (my * (a2 - a1) * inverse - mx * ssim * (1 / b1 - 1 / b2));
        mxx_[i] = -ssim / b2;
        mxy_[i] = 2 * a1 * inverse;
      }
      row_sums_[row] = sum;
    }
  });
  double ssim_sum = 0;
  for (int row = 0; row < height; ++row) {
    ssim_sum += row_sums_[row];
  }
  blur(mx_, xx_, width, height);
  blur(mxx_, yy_, width, height);
  blur(mxy_, xy_, width, height);

  const double count = 3.0 * static_cast<double>(n);
  const auto ssim_scale = static_cast<float>(-weights.dssim / count);
  const auto l1_scale = static_cast<float>((1 - weights.dssim) / count);
  parallel_for(height, kRowGrain, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      double sum = 0;
      for (size_t i = row * width; i < (row + 1) * width; ++i) {
        const float difference = x_[i] - y_[i];
        sum += std::abs(difference);
        const float sign = difference > 0 ? 1.0f : difference < 0 ? -1.0f : 0.0f;
        gradient.data[i * 4 + channel] =
            l1_scale * sign + ssim_scale * (xx_[i] + 2 * x_[i] * yy_[i] + y_[i] * xy_[i]);
      }
      row_sums_[row] = sum;
    }
  });
  double l1_sum = 0;
  for (int row = 0; row < height; ++row) {
    l1_sum += row_sums_[row];
  }
  return (1 - weights.dssim) * l1_sum / count + weights.dssim * (1.0 / 3.0 - ssim_sum / count);
}

double ImageLoss::evaluate(const Image& predicted, const Image& truth, const Vec3& background,
                           const LossWeights& weights, Image& gradient) {
  const int width = predicted.width;
  const int height = predicted.height;
  const size_t n = predicted.pixels();
  for (auto* buffer : {&x_, &y_, &xx_, &yy_, &xy_, &mx_, &my_, &mxx_, &myy_, &mxy_}) {
    buffer->resize(n);
  }
  row_sums_.resize(height);
  if (gradient.width != width || gradient.height != height || gradient.channels != 4) {
    gradient = Image(width, height, 4);
  }
  double loss = 0;
  for (int c = 0; c < 3; ++c) {
    parallel_for(n, kRowGrain * width, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const float* p = &predicted.data[i * 4];
        const float* t = &truth.data[i * 4];
        x_[i] = p[c] + (1 - p[3]) * background[c];
        y_[i] = t[c] + (1 - t[3]) * background[c];
      }
    });
    loss += evaluate_channel(c, width, height, weights, gradient);
  }
  const auto alpha_scale = static_cast<float>(weights.alpha / static_cast<double>(n));
  parallel_for(height, kRowGrain, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      double sum = 0;
      for (size_t i = row * width; i < (row + 1) * width; ++i) {
        float* g = &gradient.data[i * 4];
        const float difference = predicted.data[i * 4 + 3] - truth.data[i * 4 + 3];
        sum += std::abs(difference);
        const float sign = difference > 0 ? 1.0f : difference < 0 ? -1.0f : 0.0f;
        g[3] =
            alpha_scale * sign - (g[0] * background.x + g[1] * background.y + g[2] * background.z);
      }
      row_sums_[row] = sum;
    }
  });
  for (int row = 0; row < height; ++row) {
    loss += alpha_scale * row_sums_[row];
  }
  return loss;
}

}  // namespace clipgs
