#include "measure/metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "core/mask.h"
#include "core/parallel.h"

namespace clipgs {

void require_same_size(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) {
    throw Error("pictures of {}×{} and {}×{} pixels cannot be compared; render at the same size",
                a.width, a.height, b.width, b.height);
  }
}

namespace {

float alpha_at(const Image& image, size_t pixel) {
  return image.channels == 4 ? image.data[pixel * 4 + 3] : 1.0f;
}

Image over_black(const Image& image) { return composite(image, 0, 0, 0); }

bool shows_matter(const Image& truth, const Image& picture, size_t pixel) {
  return alpha_at(truth, pixel) > kMaskAlpha || alpha_at(picture, pixel) > kMaskAlpha;
}

double squared_error(const Image& a, const Image& b, size_t pixel) {
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double d = static_cast<double>(a.data[pixel * 3 + c]) - b.data[pixel * 3 + c];
    sum += d * d;
  }
  return sum;
}

double energy(const Image& rgb, size_t pixel) {
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double v = rgb.data[pixel * 3 + c];
    sum += v * v;
  }
  return sum;
}

constexpr int kWindow = 11;
constexpr int kRadius = kWindow / 2;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01;  // (K1·L)², L = 1
constexpr double kC2 = 0.03 * 0.03;

std::array<double, kWindow> gaussian_window() {
  std::array<double, kWindow> window{};
  for (int i = 0; i < kWindow; ++i) {
    const double x = i - kRadius;
    window[i] = std::exp(-x * x / (2 * kSigma * kSigma));
  }
  const double sum = std::accumulate(window.begin(), window.end(), 0.0);
  for (double& w : window) {
    w /= sum;
  }
  return window;
}

// The window's first and second moments of a pair of pictures x, y at one pixel.
struct Moments {
  double x = 0, y = 0, xx = 0, yy = 0, xy = 0;

  void add(double weight, const Moments& m) {
    x += weight * m.x;
    y += weight * m.y;
    xx += weight * m.xx;
    yy += weight * m.yy;
    xy += weight * m.xy;
  }
};

double ssim_of(const Moments& m) {
  const double variance_x = m.xx - m.x * m.x;
  const double variance_y = m.yy - m.y * m.y;
  const double covariance = m.xy - m.x * m.y;
  return ((2 * m.x * m.y + kC1) * (2 * covariance + kC2)) /
         ((m.x * m.x + m.y * m.y + kC1) * (variance_x + variance_y + kC2));
}

// Adds one channel's SSIM, times `weight`, to `map`. Pixels outside the picture count as zero.
void add_channel_ssim(const Image& a, const Image& b, int channel, float weight, Image& map) {
  static const std::array<double, kWindow> window = gaussian_window();
  const int width = a.width;
  const int height = a.height;
  std::vector<Moments> rows(a.pixels());
  parallel_for(height, 16, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) {
        Moments sum;
        for (int u = std::max(0, x - kRadius); u <= std::min(width - 1, x + kRadius); ++u) {
          const double va = a.at(u, y)[channel];
          const double vb = b.at(u, y)[channel];
          sum.add(window[u - x + kRadius], {va, vb, va * va, vb * vb, va * vb});
        }
        rows[static_cast<size_t>(y) * width + x] = sum;
      }
    }
  });
  parallel_for(height, 16, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < width; ++x) {
        Moments sum;
        for (int v = std::max(0, y - kRadius); v <= std::min(height - 1, y + kRadius); ++v) {
          sum.add(window[v - y + kRadius], rows[static_cast<size_t>(v) * width + x]);
        }
        *map.at(x, y) += weight * static_cast<float>(ssim_of(sum));
      }
    }
  });
}

}  // namespace

double psnr_from_mse(double mse) {
  return mse > 0 ? std::min(kMaxPsnr, -10 * std::log10(mse)) : kMaxPsnr;
}

double psnr(const Image& truth, const Image& picture) {
  require_same_size(truth, picture);
  const Image a = over_black(truth);
  const Image b = over_black(picture);
  double sum = 0;
  for (size_t i = 0; i < a.pixels(); ++i) {
    sum += squared_error(a, b, i);
  }
  return psnr_from_mse(sum / (3.0 * static_cast<double>(a.pixels())));
}

std::optional<double> SquaredError::psnr() const {
  return pixels > 0 ? std::optional(psnr_from_mse(sum / (3.0 * static_cast<double>(pixels))))
                    : std::nullopt;
}

ClassErrors masked_errors(const Image& truth, const Image& picture,
                          std::span<const PixelClass> classes) {
  require_same_size(truth, picture);
  if (classes.size() != truth.pixels()) {
    throw Error("{} pixels have classes, but the picture has {}", classes.size(), truth.pixels());
  }
  const Image a = over_black(truth);
  const Image b = over_black(picture);
  ClassErrors errors;
  for (size_t i = 0; i < a.pixels(); ++i) {
    if (shows_matter(truth, picture, i)) {
      errors[static_cast<size_t>(classes[i])].add({squared_error(a, b, i), 1});
    }
  }
  return errors;
}

SquaredError masked_error(const Image& truth, const Image& picture) {
  const std::vector<PixelClass> one(truth.pixels(), PixelClass::kOutside);
  return masked_errors(truth, picture, one)[static_cast<size_t>(PixelClass::kOutside)];
}

Image ssim_map(const Image& truth, const Image& picture) {
  require_same_size(truth, picture);
  const Image a = over_black(truth);
  const Image b = over_black(picture);
  Image map(a.width, a.height, 1);
  for (int channel = 0; channel < 3; ++channel) {
    add_channel_ssim(a, b, channel, 1.0f / 3.0f, map);
  }
  return map;
}

double mean(const Image& map) {
  return std::accumulate(map.data.begin(), map.data.end(), 0.0) /
         static_cast<double>(map.data.size());
}

std::optional<double> masked_mean(const Image& map, const Image& truth, const Image& picture) {
  require_same_size(truth, picture);
  require_same_size(truth, map);
  double sum = 0;
  size_t pixels = 0;
  for (size_t i = 0; i < map.pixels(); ++i) {
    if (shows_matter(truth, picture, i)) {
      sum += map.data[i];
      ++pixels;
    }
  }
  return pixels > 0 ? std::optional(sum / static_cast<double>(pixels)) : std::nullopt;
}

double ssim(const Image& truth, const Image& picture) { return mean(ssim_map(truth, picture)); }

std::optional<double> band_ssim(const Image& ssim_map, const Image& depth, const Camera& camera,
                                const Plane& plane, float half_width) {
  require_same_size(ssim_map, depth);
  double sum = 0;
  size_t count = 0;
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const float distance = *depth.at(x, y);
      if (distance <= 0) {
        continue;
      }
      const Vec3 ray =
          camera.ray_direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
      if (std::abs(plane.signed_distance(camera.position + distance * ray)) <= half_width) {
        sum += *ssim_map.at(x, y);
        ++count;
      }
    }
  }
  if (count == 0) {
    return std::nullopt;
  }
  return sum / static_cast<double>(count);
}

std::optional<double> Leak::percent() const {
  return truth > 0 ? std::optional(100 * leaked / truth) : std::nullopt;
}

Leak leak(const Image& truth, const Image& uncut_truth, const Image& picture) {
  require_same_size(truth, uncut_truth);
  require_same_size(truth, picture);
  const Image a = over_black(truth);
  const Image b = over_black(picture);
  Leak sum;
  for (size_t i = 0; i < a.pixels(); ++i) {
    sum.truth += energy(a, i);
    if (alpha_at(truth, i) < kEmptyAlpha && alpha_at(uncut_truth, i) >= kEmptyAlpha) {
      sum.leaked += energy(b, i);
    }
  }
  return sum;
}

}  // namespace clipgs
