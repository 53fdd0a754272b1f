#include "cinema/denoise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr int kWindow = 6;              // px to either side that are looked at
constexpr int kPatch = 1;               // px to either side that are compared
constexpr float kColor = 0.35f;         // of the noise: what differs by more is another thing
constexpr float kFeature = 0.6f;        // the same for the albedo
constexpr float kLeastFeature = 2e-3f;  // variance below which albedos count as the same
constexpr float kLeastColor = 1e-6f;

/// Values whose differences are compared: four channels a pixel, and their variance.
struct Guide {
  std::vector<Vec4> values;
  std::vector<float> variance;  // mean over the channels
};

/// Square roots, whose noise depends less on how bright a pixel is.
std::vector<Vec4> stabilized(const Image& half, float exposure) {
  std::vector<Vec4> values(half.pixels());
  for (size_t i = 0; i < values.size(); ++i) {
    const float* p = &half.data[i * half.channels];
    for (int c = 0; c < 3; ++c) {
      values[i][c] = std::sqrt(std::max(0.0f, exposure * p[c]));
    }
    values[i].w = half.channels == 4 ? p[3] : 0.0f;
  }
  return values;
}

/// Variance of a half, from the difference of both, smoothed over the pixels beside.
std::vector<float> variance_of(const std::vector<Vec4>& a, const std::vector<Vec4>& b, int width,
                               int height) {
  std::vector<float> result(a.size());
  parallel_for(static_cast<size_t>(height), 8, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width; ++x) {
        float sum = 0;
        int count = 0;
        for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
          for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
            const size_t j = static_cast<size_t>(v) * width + u;
            const Vec4 difference = a[j] - b[j];
            sum += glm::dot(difference, difference) / 8;  // half of it a channel
            ++count;
          }
        }
        result[row * width + x] = sum / static_cast<float>(count);
      }
    }
  });
  return result;
}

/// How different two pixels are beyond what their noise explains; 0: not at all.
float difference(const Guide& guide, size_t p, size_t q, float strictness, float least) {
  const Vec4 d = guide.values[p] - guide.values[q];
  const float vp = guide.variance[p];
  const float vq = guide.variance[q];
  return (0.25f * glm::dot(d, d) - (vp + std::min(vp, vq))) /
         (least + strictness * strictness * (vp + vq));
}

/// Means of `source` (4 channels) around every pixel, weighted by how alike the guides are there.
Image filtered(const Image& source, const Guide& color, const Guide& albedo) {
  const int width = source.width;
  const int height = source.height;
  Image result(width, height, 4);
  parallel_for(static_cast<size_t>(height), 2, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width; ++x) {
        const size_t p = row * width + x;
        Vec4 sum(0);
        float weights = 0;
        for (int v = std::max(0, y - kWindow); v <= std::min(height - 1, y + kWindow); ++v) {
          for (int u = std::max(0, x - kWindow); u <= std::min(width - 1, x + kWindow); ++u) {
            const size_t q = static_cast<size_t>(v) * width + u;
            const float feature = difference(albedo, p, q, kFeature, kLeastFeature);
            constexpr float kHopeless = 6;
            if (feature > kHopeless) {
              continue;
            }
            float patch = 0;
            int count = 0;
            for (int dy = -kPatch; dy <= kPatch; ++dy) {
              for (int dx = -kPatch; dx <= kPatch; ++dx) {
                const bool inside = std::min(x, u) + dx >= 0 && std::max(x, u) + dx < width &&
                                    std::min(y, v) + dy >= 0 && std::max(y, v) + dy < height;
                if (inside) {
                  const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(dy) * width + dx;
                  patch += difference(color, p + step, q + step, kColor, kLeastColor);
                  ++count;
                }
              }
            }
            const float unlike = std::max({0.0f, patch / static_cast<float>(count), feature});
            const float weight = std::exp(-unlike);
            const float* in = &source.data[4 * q];
            sum += weight * Vec4(in[0], in[1], in[2], in[3]);
            weights += weight;
          }
        }
        sum /= weights;  // the pixel itself weighs 1
        std::copy_n(&sum[0], 4, result.at(x, y));
      }
    }
  });
  return result;
}

}  // namespace

Picture denoise(const Picture& picture, float exposure) {
  const int width = picture.half_a.width;
  const int height = picture.half_a.height;
  const std::vector<Vec4> a = stabilized(picture.half_a, exposure);
  const std::vector<Vec4> b = stabilized(picture.half_b, exposure);
  const std::vector<float> variance = variance_of(a, b, width, height);

  std::vector<Vec4> albedo = stabilized(picture.albedo_a, 1);
  const std::vector<Vec4> other = stabilized(picture.albedo_b, 1);
  std::vector<float> albedo_variance = variance_of(albedo, other, width, height);
  for (size_t i = 0; i < albedo.size(); ++i) {
    albedo[i] = 0.5f * (albedo[i] + other[i]);
    albedo_variance[i] *= 0.5f;  // of the mean of two
  }
  const Guide features{std::move(albedo), std::move(albedo_variance)};

  Picture result = picture;
  result.half_a = filtered(picture.half_a, {b, variance}, features);
  result.half_b = filtered(picture.half_b, {a, variance}, features);
  return result;
}

}  // namespace clipgs
