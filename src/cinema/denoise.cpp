#include "cinema/denoise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <numbers>
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
constexpr float kHopeless = 6;  // difference of albedos from which on colours do not matter

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
struct Half {
  Channels<4> source;
  Guide<4> color;
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
  Channel result(single.size());
  parallel_for(static_cast<size_t>(height), 8, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < width; ++x) {
        const Rectangle patch = patch_around(x, y, {0, 0, width, height});
        float sum = 0;
        for (int v = patch.y0; v < patch.y1; ++v) {
          for (int u = patch.x0; u < patch.x1; ++u) {
            sum += single[static_cast<size_t>(v) * width + u];
          }
        }
        result[row * width + x] = sum / static_cast<float>(patch.width() * patch.height());
      }
    }
  });
  return result;
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
class TileFilter {
 public:
  TileFilter(const std::array<Half, 2>& halves, const Guide<3>& albedo, int width, int height,
             const Rectangle& tile)
      : halves_(halves), albedo_(albedo), width_(width), height_(height), tile_(tile) {}

  void run() {
    for (int dx = -kWindow; dx <= kWindow; ++dx) {
      share_columns(dx);
      for (int dy = -kWindow; dy <= kWindow; ++dy) {
        add_neighbours(dx, dy);
      }
    }
  }

  void write(size_t half, Image& result) const {
    const Sums& sums = sums_[half];
    for (int y = tile_.y0; y < tile_.y1; ++y) {
      for (int x = tile_.x0; x < tile_.x1; ++x) {
        const size_t i = in_tile(x, y);
        for (size_t c = 0; c < 4; ++c) {
          result.at(x, y)[c] = sums.channels[c][i] / sums.weights[i];  // the pixel itself weighs 1
        }
      }
    }
  }

 private:
  using TileChannel = std::array<float, static_cast<size_t>(kTileWidth) * kTileHeight>;
  struct Sums {
    std::array<TileChannel, 4> channels{};
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
    compare_colors(intersection(tile_.grown(kPatch), all), step);
    for (int y = inside.y0; y < inside.y1; ++y) {
      const size_t p = in_picture(inside.x0, y);
      compare_albedos(p, p + step, count);
      const float share = 1 / static_cast<float>(patch_around(inside.x0, y, all).height());
      for (size_t half = 0; half < 2; ++half) {
        weigh(half, inside.x0, y, count, share);
        add_row(half, p + step, in_tile(inside.x0, y), count);
      }
    }
  }

  /// Fills features_ for pixels from p on and their neighbours from q on.
  void compare_albedos(size_t p, size_t q, int count) {
    compare_rows(albedo_, p, q, count, kFeature, kLeastFeature, features_.data());
    for (int i = 0; i < count; ++i) {
      const float feature = features_[i];
      features_[i] = feature > kHopeless ? kNothing : std::max(0.0f, feature);
    }
  }

  /// Fills differences_: 0 for pairs that are not in the picture, which count for nothing.
  void compare_colors(const Rectangle& where, std::ptrdiff_t step) {
    for (size_t half = 0; half < 2; ++half) {
      differences_[half].fill(0);
      for (int y = where.y0; y < where.y1; ++y) {
        const size_t p = in_picture(where.x0, y);
        compare_rows(halves_[half].color, p, p + step, where.width(), kColor, kLeastColor,
                     &differences_[half][in_differences(where.x0, y)]);
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
    for (size_t c = 0; c < 4; ++c) {
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

  const std::array<Half, 2>& halves_;
  const Guide<3>& albedo_;
  int width_, height_;  // of the picture
  Rectangle tile_;
  std::array<float, kTileWidth> column_share_;  // of a column of a patch in its mean
  std::array<std::array<float, static_cast<size_t>(kStride) * (kTileHeight + 2 * kPatch)>, 2>
      differences_;
  std::array<float, kTileWidth> features_;  // differences of the albedos
  std::array<float, kTileWidth> weights_;
  std::array<Sums, 2> sums_;
};

/// Means of the halves around every pixel, weighted by how alike the guides are there.
void filter(const std::array<Half, 2>& halves, const Guide<3>& albedo, Picture& result) {
  const int width = result.half_a.width;
  const int height = result.half_a.height;
  const int columns = (width + kTileWidth - 1) / kTileWidth;
  const int rows = (height + kTileHeight - 1) / kTileHeight;
  parallel_for(static_cast<size_t>(columns) * rows, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int x = static_cast<int>(i % columns) * kTileWidth;
      const int y = static_cast<int>(i / columns) * kTileHeight;
      const Rectangle tile = {x, y, std::min(width, x + kTileWidth),
                              std::min(height, y + kTileHeight)};
      const auto tile_filter = std::make_unique<TileFilter>(halves, albedo, width, height, tile);
      tile_filter->run();
      tile_filter->write(0, result.half_a);
      tile_filter->write(1, result.half_b);
    }
  });
}

/// The mean of the albedos of both halves.
Guide<3> albedo_guide(const Picture& picture) {
  Guide<3> guide;
  guide.values = stabilized(channels_of<3>(picture.albedo_a), 1);
  const Channels<3> other = stabilized(channels_of<3>(picture.albedo_b), 1);
  guide.variance =
      variance_of(guide.values, other, picture.albedo_a.width, picture.albedo_a.height);
  for (float& variance : guide.variance) {
    variance *= 0.5f;  // of the mean of two
  }
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < other[c].size(); ++i) {
      guide.values[c][i] = 0.5f * (guide.values[c][i] + other[c][i]);
    }
  }
  return guide;
}

}  // namespace

Picture denoise(const Picture& picture, float exposure) {
  std::array<Half, 2> halves;
  Guide<4>& b = halves[0].color;
  Guide<4>& a = halves[1].color;
  halves[0].source = channels_of<4>(picture.half_a);
  halves[1].source = channels_of<4>(picture.half_b);
  a.values = stabilized(halves[0].source, exposure);
  b.values = stabilized(halves[1].source, exposure);
  a.variance = variance_of(a.values, b.values, picture.half_a.width, picture.half_a.height);
  b.variance = a.variance;

  Picture result = picture;
  filter(halves, albedo_guide(picture), result);
  return result;
}

}  // namespace clipgs
