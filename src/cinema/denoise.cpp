#include "cinema/denoise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr int kWindow = 6;            // px to either side that are looked at
constexpr int kPatch = 1;             // px to either side that are compared
constexpr int kFeatureWindow = 2;     // px to either side that features are cleaned over
constexpr float kColor = 0.8f;        // of the noise: what differs by more is another thing
constexpr float kFeature = 1;         // the same for features
constexpr float kLeastColor = 1e-6f;  // variances below which values count as the same
constexpr float kLeastAlbedo = 4e-3f;
constexpr float kLeastNormal = 2e-2f;
constexpr float kLeastDepthVariance = 8;  // mm²
constexpr float kFeatureShare = 0.1f;     // of the least variances when features are cleaned
constexpr int kErrorRadius = 3;           // px: estimates of errors are smoothed this far

// Of a tile, in px: what is summed up for one stays in the fastest cache.
constexpr int kTileWidth = 64;
constexpr int kTileHeight = 16;

using Channel = std::vector<float>;

/// Each channel by itself: neighbours in a row lie in neighbouring lanes of a vector.
template <size_t N>
using Channels = std::array<Channel, N>;

/// Values whose differences are compared, and their variance.
template <size_t N>
struct Guide {
  Channels<N> values;
  Channel variance;  // mean over four channels
};

/// What is averaged, and what tells how alike its pixels are.
template <size_t N>
struct Half {
  Channels<N> source;
  Guide<N> guide;
};

/// Of both halves together: hardly noisy, and told pixel by pixel.
struct FeatureGuides {
  Guide<3> albedo;
  Guide<3> normal;
  Guide<1> depth;
};

/// How pixels are compared.
struct Comparison {
  int window;        // px to either side
  float strictness;  // of the noise
  float least;       // variance
};

/// The pixels of [x0, x1) × [y0, y1).
struct Rectangle {
  int x0, y0, x1, y1;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  Rectangle grown(int by) const { return {x0 - by, y0 - by, x1 + by, y1 + by}; }
};

Rectangle intersection(const Rectangle& a, const Rectangle& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

/// What of the patch around a pixel lies in a rectangle around that.
Rectangle patch_around(int x, int y, const Rectangle& within) {
  return intersection(Rectangle{x, y, x + 1, y + 1}.grown(kPatch), within);
}

template <size_t N>
Channels<N> channels_of(const Image& image) {
  Channels<N> channels;
  for (size_t c = 0; c < N; ++c) {
    channels[c].resize(image.pixels());
    for (size_t i = 0; i < channels[c].size(); ++i) {
      channels[c][i] = image.data[i * N + c];
    }
  }
  return channels;
}

/// Square roots of the colours, whose noise depends less on how bright a pixel is.
template <size_t N>
Channels<N> stabilized(Channels<N> channels, float exposure) {
  for (size_t c = 0; c < 3; ++c) {
    for (float& value : channels[c]) {
      value = std::sqrt(std::max(0.0f, exposure * value));
    }
  }
  return channels;
}

/// Means over the pixels up to `radius` away.
Channel smoothed(const Channel& channel, int width, int height, int radius) {
  Channel result(channel.size());
  parallel_for(static_cast<size_t>(height), 8, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width; ++x) {
        const Rectangle around = intersection(Rectangle{x, y, x + 1, y + 1}.grown(radius),
                                              Rectangle{0, 0, width, height});
        float sum = 0;
        for (int v = around.y0; v < around.y1; ++v) {
          for (int u = around.x0; u < around.x1; ++u) {
            sum += channel[static_cast<size_t>(v) * width + u];
          }
        }
        result[row * width + x] = sum / static_cast<float>(around.width() * around.height());
      }
    }
  });
  return result;
}

/// Variance of a half, from the difference of both, smoothed over patches.
template <size_t N>
Channel variance_of(const Channels<N>& a, const Channels<N>& b, int width, int height) {
  Channel single(a[0].size());
  for (size_t c = 0; c < N; ++c) {
    for (size_t i = 0; i < single.size(); ++i) {
      const float difference = a[c][i] - b[c][i];
      single[i] += difference * difference / 8;  // half of it a channel
    }
  }
  return smoothed(single, width, height, kPatch);
}

constexpr float kNothing = 88;  // exp_of_minus() is 0 there

/// exp(−x) of x in [0, kNothing], to 1e-5 of it. The library's takes one number a call, which keeps
/// loops from being vectorised.
inline float exp_of_minus(float x) {
  constexpr float kLn2 = std::numbers::ln2_v<float>;
  // NOLINTNEXTLINE(bugprone-incorrect-roundings): lround() would be another call
  const int halvings = static_cast<int>(x * (1 / kLn2) + 0.5f);
  const float r = static_cast<float>(halvings) * kLn2 - x;  // of ±ln(2)/2: Taylor
  const float e = 1 + r * (1 + r * (1 / 2.f + r * (1 / 6.f + r * (1 / 24.f + r * (1 / 120.f)))));
  return e * std::bit_cast<float>((127 - halvings) << 23);
}

/// How different pixels are beyond what their noise explains, 0: not at all, of `count` pairs from
/// p and q on.
template <size_t N>
void compare_rows(const Guide<N>& guide, size_t p, size_t q, int count, float strictness,
                  float least, float* __restrict out) {
  std::array<const float*, N> a;
  std::array<const float*, N> b;
  for (size_t c = 0; c < N; ++c) {
    a[c] = &guide.values[c][p];
    b[c] = &guide.values[c][q];
  }
  const float* const variance_a = &guide.variance[p];
  const float* const variance_b = &guide.variance[q];
  for (int i = 0; i < count; ++i) {
    float square = 0;
    for (size_t c = 0; c < N; ++c) {
      const float d = a[c][i] - b[c][i];
      square += d * d;
    }
    const float va = variance_a[i];
    const float vb = variance_b[i];
    out[i] =
        (0.25f * square - (va + std::min(va, vb))) / (least + strictness * strictness * (va + vb));
  }
}

/// Averages the pixels of one tile over their neighbours, one offset to these after the other: a
/// difference of colours then serves all the patches it is part of, and rows of pixels have the
/// same to do.
template <size_t N>
class TileFilter {
 public:
  /// `features`: null for none.
  TileFilter(const std::array<Half<N>, 2>& halves, const FeatureGuides* features,
             const Comparison& comparison, int width, int height, const Rectangle& tile)
      : halves_(halves),
        guides_(features),
        comparison_(comparison),
        width_(width),
        height_(height),
        tile_(tile) {}

  void run() {
    for (int dx = -comparison_.window; dx <= comparison_.window; ++dx) {
      share_columns(dx);
      for (int dy = -comparison_.window; dy <= comparison_.window; ++dy) {
        add_neighbours(dx, dy);
      }
    }
  }

  void write(size_t half, Channels<N>& result) const {
    const Sums& sums = sums_[half];
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (int x = tile_.x0; x < tile_.x1; ++x) {
        const size_t i = in_tile(x, y);
        for (size_t c = 0; c < N; ++c) {
          result[c][in_picture(x, y)] =
              sums.channels[c][i] / sums.weights[i];  // the pixel itself weighs 1
        }
      }
    }
  }

 private:
  using TileChannel = std::array<float, static_cast<size_t>(kTileWidth) * kTileHeight>;
  struct Sums {
    std::array<TileChannel, N> channels{};
    TileChannel weights{};
  };

  static constexpr int kStride = kTileWidth + 2 * kPatch;  // of differences

  /// The pixels whose neighbour at an offset is in the picture.
  Rectangle paired(int dx, int dy) const {
    return {std::max(0, -dx), std::max(0, -dy), std::min(width_, width_ - dx),
            std::min(height_, height_ - dy)};
  }
  size_t in_picture(int x, int y) const { return static_cast<size_t>(y) * width_ + x; }
  size_t in_tile(int x, int y) const {
    return static_cast<size_t>(y - tile_.y0) * kTileWidth + (x - tile_.x0);
  }
  size_t in_differences(int x, int y) const {
    return static_cast<size_t>(y - tile_.y0 + kPatch) * kStride + (x - tile_.x0 + kPatch);
  }

  void share_columns(int dx) {
    const Rectangle all = paired(dx, 0);
    const Rectangle inside = intersection(tile_, all);
    for (int x = inside.x0; x < inside.x1; ++x) {
      const Rectangle patch = patch_around(x, inside.y0, all);
      column_share_[x - tile_.x0] = 1 / static_cast<float>(patch.width());
    }
  }

  void add_neighbours(int dx, int dy) {
    const Rectangle all = paired(dx, dy);
    const Rectangle inside = intersection(tile_, all);
    const int count = inside.width();
    if (count <= 0 || inside.height() <= 0) {
      return;
    }
    const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(dy) * width_ + dx;
    compare_halves(intersection(tile_.grown(kPatch), all), step);
    for (int y = inside.y0; y < inside.y1; ++y) {
      const size_t p = in_picture(inside.x0, y);
      compare_features(p, p + step, count);
      const float share = 1 / static_cast<float>(patch_around(inside.x0, y, all).height());
      for (size_t half = 0; half < 2; ++half) {
        weigh(half, inside.x0, y, count, share);
        add_row(half, p + step, in_tile(inside.x0, y), count);
      }
    }
  }

  /// Fills features_ for pixels from p on and their neighbours from q on: the largest difference.
  void compare_features(size_t p, size_t q, int count) {
    features_.fill(0);
    if (guides_ != nullptr) {
      compare_feature(guides_->albedo, kLeastAlbedo, p, q, count);
      compare_feature(guides_->normal, kLeastNormal, p, q, count);
      compare_feature(guides_->depth, kLeastDepthVariance, p, q, count);
    }
  }
  template <size_t M>
  void compare_feature(const Guide<M>& guide, float least, size_t p, size_t q, int count) {
    compare_rows(guide, p, q, count, kFeature, least, weights_.data());
    for (int i = 0; i < count; ++i) {
      features_[i] = std::max(features_[i], weights_[i]);
    }
  }

  /// Fills differences_: 0 for pairs that are not in the picture, which count for nothing.
  void compare_halves(const Rectangle& where, std::ptrdiff_t step) {
    for (size_t half = 0; half < 2; ++half) {
      differences_[half].fill(0);
      for (int y = where.y0; y < where.y1; ++y) {
        const size_t p = in_picture(where.x0, y);
        compare_rows(halves_[half].guide, p, p + step, where.width(), comparison_.strictness,
                     comparison_.least, &differences_[half][in_differences(where.x0, y)]);
      }
    }
  }

  /// Fills weights_ for pixels from (x, y) on. `row_share`: of a row of a patch in its mean.
  void weigh(size_t half, int x, int y, int count, float row_share) {
    const float* const middle = &differences_[half][in_differences(x, y)];
    std::array<float, kStride> columns;  // of patches
    for (int i = 0; i < count + 2 * kPatch; ++i) {
      const float* const at = middle + i - kPatch;
      columns[i] = at[-kStride] + at[0] + at[kStride];
    }
    const float* const column_share = &column_share_[x - tile_.x0];
    static_assert(kPatch == 1, "three rows and three columns are added up");
    for (int i = 0; i < count; ++i) {
      const float sum = columns[i] + columns[i + 1] + columns[i + 2];
      const float patch = sum * (row_share * column_share[i]);
      weights_[i] = std::min(kNothing, std::max(features_[i], patch));
    }
    // Apart from the loop before, where compilers would branch for the limit, a pixel at a time.
    for (int i = 0; i < count; ++i) {
      weights_[i] = exp_of_minus(weights_[i]);
    }
  }

  /// Adds the weighted pixels from q on to the sums of the pixels of the tile from `to` on.
  void add_row(size_t half, size_t q, size_t to, int count) {
    for (size_t c = 0; c < N; ++c) {
      const float* const source = &halves_[half].source[c][q];
      float* const sum = &sums_[half].channels[c][to];
      for (int i = 0; i < count; ++i) {
        sum[i] += weights_[i] * source[i];
      }
    }
    float* const sum = &sums_[half].weights[to];
    for (int i = 0; i < count; ++i) {
      sum[i] += weights_[i];
    }
  }

  const std::array<Half<N>, 2>& halves_;
  const FeatureGuides* guides_;
  Comparison comparison_;
  int width_, height_;  // of the picture
  Rectangle tile_;
  std::array<float, kTileWidth> column_share_;  // of a column of a patch in its mean
  std::array<std::array<float, static_cast<size_t>(kStride) * (kTileHeight + 2 * kPatch)>, 2>
      differences_;
  std::array<float, kTileWidth> features_;  // differences of the features
  std::array<float, kTileWidth> weights_{};
  std::array<Sums, 2> sums_;
};

/// Means of the halves around every pixel, weighted by how alike the guides are there.
template <size_t N>
std::array<Channels<N>, 2> filtered(const std::array<Half<N>, 2>& halves,
                                    const FeatureGuides* features, const Comparison& comparison,
                                    int width, int height) {
  std::array<Channels<N>, 2> result = {halves[0].source, halves[1].source};
  const int columns = (width + kTileWidth - 1) / kTileWidth;
  const int rows = (height + kTileHeight - 1) / kTileHeight;
  parallel_for(static_cast<size_t>(columns) * rows, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int x = static_cast<int>(i % columns) * kTileWidth;
      const int y = static_cast<int>(i / columns) * kTileHeight;
      const Rectangle tile = {x, y, std::min(width, x + kTileWidth),
                              std::min(height, y + kTileHeight)};
      const auto tile_filter =
          std::make_unique<TileFilter<N>>(halves, features, comparison, width, height, tile);
      tile_filter->run();
      tile_filter->write(0, result[0]);
      tile_filter->write(1, result[1]);
    }
  });
  return result;
}

/// The mean of a feature's halves, each filtered by what the other shows of it.
template <size_t N>
Guide<N> feature_guide(Channels<N> a, Channels<N> b, float least, int width, int height) {
  const Channel variance = variance_of(a, b, width, height);
  const std::array<Half<N>, 2> halves = {Half<N>{a, {b, variance}}, Half<N>{b, {a, variance}}};
  const auto [clean_a, clean_b] =
      filtered(halves, nullptr, {kFeatureWindow, kFeature, kFeatureShare * least}, width, height);
  Guide<N> guide{clean_a, variance_of(clean_a, clean_b, width, height)};
  for (float& v : guide.variance) {
    v *= 0.5f;  // of the mean of two
  }
  for (size_t c = 0; c < N; ++c) {
    for (size_t i = 0; i < clean_b[c].size(); ++i) {
      guide.values[c][i] = 0.5f * (clean_a[c][i] + clean_b[c][i]);
    }
  }
  return guide;
}

FeatureGuides feature_guides(const Features& a, const Features& b) {
  const int width = a.albedo.width;
  const int height = a.albedo.height;
  return {feature_guide(stabilized(channels_of<3>(a.albedo), 1),
                        stabilized(channels_of<3>(b.albedo), 1), kLeastAlbedo, width, height),
          feature_guide(channels_of<3>(a.normal), channels_of<3>(b.normal), kLeastNormal, width,
                        height),
          feature_guide(channels_of<1>(a.depth), channels_of<1>(b.depth), kLeastDepthVariance,
                        width, height)};
}

void put(const Channels<4>& channels, Image& image) {
  for (size_t c = 0; c < 4; ++c) {
    for (size_t i = 0; i < channels[c].size(); ++i) {
      image.data[4 * i + c] = channels[c][i];
    }
  }
}

/// How much of the filtered picture to take in every pixel, 0…1, for the least squared error of
/// what is displayed. The error of the noisy mean is what its halves tell; that of a filtered half
/// is its distance from the noisy other half, less that one's own noise. Errors of one pixel are
/// noise themselves: they are smoothed.
Channel share_of_filtered(const Picture& noisy, const Picture& filtered,
                          const DisplayTransform& transform) {
  const auto shown = [&](const Image& half) {
    return composite(display(half, transform), 0, 0, 0);
  };
  const Image a = shown(noisy.half_a);
  const Image b = shown(noisy.half_b);
  const Image filtered_a = shown(filtered.half_a);
  const Image filtered_b = shown(filtered.half_b);
  Channel of_noisy(a.pixels());
  Channel of_filtered(a.pixels());
  for (size_t i = 0; i < a.data.size(); ++i) {
    const float between = a.data[i] - b.data[i];
    const float left = filtered_a.data[i] - b.data[i];
    const float right = filtered_b.data[i] - a.data[i];
    of_noisy[i / 3] += 0.25f * between * between;
    of_filtered[i / 3] += 0.5f * (left * left + right * right - between * between);
  }
  of_noisy = smoothed(of_noisy, a.width, a.height, kErrorRadius);
  of_filtered = smoothed(of_filtered, a.width, a.height, kErrorRadius);
  for (size_t i = 0; i < of_noisy.size(); ++i) {
    const float sum = of_noisy[i] + std::max(0.0f, of_filtered[i]);
    of_noisy[i] = sum > 0 ? of_noisy[i] / sum : 1;
  }
  return smoothed(of_noisy, a.width, a.height, 1);
}

void mix(const Image& noisy, const Channel& share, Image& filtered) {
  for (size_t i = 0; i < noisy.data.size(); ++i) {
    filtered.data[i] = std::lerp(noisy.data[i], filtered.data[i], share[i / 4]);
  }
}

}  // namespace

Picture denoise(const Picture& picture, const DisplayTransform& transform) {
  const int width = picture.half_a.width;
  const int height = picture.half_a.height;
  if (picture.features_a.depth.data.empty()) {
    throw Error("denoise: the picture was rendered without features");
  }
  std::array<Half<4>, 2> halves;
  Guide<4>& b = halves[0].guide;
  Guide<4>& a = halves[1].guide;
  halves[0].source = channels_of<4>(picture.half_a);
  halves[1].source = channels_of<4>(picture.half_b);
  a.values = stabilized(halves[0].source, transform.exposure);
  b.values = stabilized(halves[1].source, transform.exposure);
  a.variance = variance_of(a.values, b.values, width, height);
  b.variance = a.variance;

  const FeatureGuides features = feature_guides(picture.features_a, picture.features_b);
  const auto means = filtered(halves, &features, {kWindow, kColor, kLeastColor}, width, height);
  Picture result = picture;
  put(means[0], result.half_a);
  put(means[1], result.half_b);
  const Channel share = share_of_filtered(picture, result, transform);
  mix(picture.half_a, share, result.half_a);
  mix(picture.half_b, share, result.half_b);
  return result;
}

}  // namespace clipgs
