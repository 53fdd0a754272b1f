#include "splat/rasterizer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "splat/behind.h"
#include "splat/tile_kernel.h"

namespace clipgs {

namespace {

constexpr size_t kGaussianGrain = 2048;
constexpr size_t kBinChunk = 8192;

/// Inclusive range of tiles that a splat's box touches.
struct TileBox {
  int x0, x1, y0, y1;
  int count() const { return (x1 - x0 + 1) * (y1 - y0 + 1); }
};

TileBox tile_box(const Splat& s, int tiles_x, int tiles_y) {
  // Bounded as floats: a splat may be larger than any integer.
  const auto tile = [](float pixel, int tiles) {
    const float last = static_cast<float>(tiles) - 1;
    return static_cast<int>(std::clamp(std::floor(pixel / kTileSize), 0.0f, last));
  };
  return {tile(s.x - s.extent_x, tiles_x), tile(s.x + s.extent_x, tiles_x),
          tile(s.y - s.extent_y, tiles_y), tile(s.y + s.extent_y, tiles_y)};
}

TileLimits limits_of(const RasterOptions& options) {
  return {options.alpha_min, options.alpha_max, options.transmittance_min};
}

/// Calls body(tile-local index, image pixel index) for the pixels of a tile inside the picture.
template <typename Body>
void for_tile_pixels(const Image& image, int tile_x, int tile_y, const Body& body) {
  const int x_end = std::min(kTileSize, image.width - tile_x * kTileSize);
  const int y_end = std::min(kTileSize, image.height - tile_y * kTileSize);
  const int image_x = tile_x * kTileSize;
  for (int y = 0; y < y_end; ++y) {
    const size_t row = static_cast<size_t>(tile_y) * kTileSize + y;
    for (int x = 0; x < x_end; ++x) {
      body(y * kTileSize + x, row * image.width + image_x + x);
    }
  }
}

}  // namespace

void Rasterizer::project_all(const Gaussians& gaussians) {
  projected_.resize(gaussians.size());
  const size_t more = more_planes();
  more_cuts_.resize(gaussians.size() * more);
  visible_.resize(gaussians.size());
  parallel_for(gaussians.size(), kGaussianGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const bool seen = project(gaussians, i, camera_, planes_, options_, projected_[i],
                                more_cuts_.data() + i * more);
      visible_[i] = seen ? 1 : 0;
    }
  });
  order_.clear();
  for (size_t i = 0; i < gaussians.size(); ++i) {
    if (visible_[i] != 0) {
      order_.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

void Rasterizer::sort_by_depth() {
  // Positive floats sort as their bits do. Stable LSD radix sort, so that ties keep index order.
  constexpr int kRadixBits = 11;
  constexpr std::uint32_t kBuckets = 1U << kRadixBits;
  sort_scratch_.resize(order_.size());
  for (int shift = 0; shift < 32; shift += kRadixBits) {
    const auto digit = [&](std::uint32_t i) {
      return std::bit_cast<std::uint32_t>(projected_[i].depth) >> shift & (kBuckets - 1);
    };
    std::vector<std::uint32_t> next(kBuckets + 1, 0);
    for (const std::uint32_t i : order_) {
      ++next[digit(i) + 1];
    }
    for (std::uint32_t b = 0; b < kBuckets; ++b) {
      next[b + 1] += next[b];
    }
    for (const std::uint32_t i : order_) {
      sort_scratch_[next[digit(i)]++] = i;
    }
    order_.swap(sort_scratch_);
  }
  splats_.resize(order_.size());
  const size_t more = more_planes();
  cuts_.resize(order_.size() * more);
  rank_.resize(projected_.size());
  parallel_for(order_.size(), kGaussianGrain, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      splats_[k] = projected_[order_[k]];
      std::copy_n(more_cuts_.begin() + static_cast<std::ptrdiff_t>(order_[k] * more), more,
                  cuts_.begin() + static_cast<std::ptrdiff_t>(k * more));
      rank_[order_[k]] = static_cast<std::uint32_t>(k);
    }
  });
}

void Rasterizer::bin_into_tiles() {
  const size_t tiles = static_cast<size_t>(tiles_x_) * tiles_y_;
  slot_begin_.assign(splats_.size() + 1, 0);
  for (size_t k = 0; k < splats_.size(); ++k) {
    slot_begin_[k + 1] = slot_begin_[k] + tile_box(splats_[k], tiles_x_, tiles_y_).count();
  }
  const auto for_tiles = [&](size_t k, const auto& body) {
    const TileBox box = tile_box(splats_[k], tiles_x_, tiles_y_);
    std::uint32_t slot = slot_begin_[k];
    for (int y = box.y0; y <= box.y1; ++y) {
      for (int x = box.x0; x <= box.x1; ++x) {
        body(static_cast<size_t>(y) * tiles_x_ + x, slot++);
      }
    }
  };

  // Counting sort by tile in chunks of splats: each chunk knows where its part of a list begins.
  const size_t chunks = (splats_.size() + kBinChunk - 1) / kBinChunk;
  chunk_counts_.assign(chunks * tiles, 0);
  parallel_for(splats_.size(), kBinChunk, [&](size_t begin, size_t end) {
    std::uint32_t* counts = &chunk_counts_[begin / kBinChunk * tiles];
    for (size_t k = begin; k < end; ++k) {
      for_tiles(k, [&](size_t tile, std::uint32_t) { ++counts[tile]; });
    }
  });
  tile_begin_.assign(tiles + 1, 0);
  std::uint32_t total = 0;
  for (size_t tile = 0; tile < tiles; ++tile) {
    tile_begin_[tile] = total;
    for (size_t chunk = 0; chunk < chunks; ++chunk) {
      const std::uint32_t count = chunk_counts_[chunk * tiles + tile];
      chunk_counts_[chunk * tiles + tile] = total;
      total += count;
    }
  }
  tile_begin_[tiles] = total;
  list_.resize(total);
  slots_.resize(total);
  parallel_for(splats_.size(), kBinChunk, [&](size_t begin, size_t end) {
    std::uint32_t* next = &chunk_counts_[begin / kBinChunk * tiles];
    for (size_t k = begin; k < end; ++k) {
      for_tiles(k, [&](size_t tile, std::uint32_t slot) {
        list_[next[tile]] = static_cast<std::uint32_t>(k);
        slots_[next[tile]++] = slot;
      });
    }
  });
}

const Image& Rasterizer::forward(const Gaussians& gaussians, const Camera& camera, const Cut& cut,
                                 const RasterOptions& options, const Image* front) {
  front_ = front != nullptr ? *front : Image();
  camera_ = camera;
  planes_.clear();
  for (const Plane& plane : cut.planes()) {
    planes_.push_back(
        {plane, options.face_gain.none() ? Vec3(1) : options.face_gain.at(plane.normal)});
  }
  options_ = options;
  tiles_x_ = (camera.width + kTileSize - 1) / kTileSize;
  tiles_y_ = (camera.height + kTileSize - 1) / kTileSize;
  if (image_.width != camera.width || image_.height != camera.height) {
    image_ = Image(camera.width, camera.height, 4);
  }
  share_ = options.kept_share ? KeptShare(camera, cut, gaussians) : KeptShare();
  const bool is_whole = share_.is_whole();
  Image& alone = front != nullptr || !is_whole ? alone_ : image_;
  if (alone.data.size() != image_.data.size()) {
    alone = Image(camera.width, camera.height, 4);
  }
  project_all(gaussians);
  sort_by_depth();
  bin_into_tiles();

  const TileLimits limits = limits_of(options_);
  const size_t tiles = static_cast<size_t>(tiles_x_) * tiles_y_;
  used_.resize(tiles);
  parallel_for(tiles, 1, [&](size_t tile_index, size_t) {
    const int tx = static_cast<int>(tile_index) % tiles_x_;
    const int ty = static_cast<int>(tile_index) / tiles_x_;
    const std::uint32_t begin = tile_begin_[tile_index];
    Tile tile;
    start(tx, ty, tile);
    used_[tile_index] = static_cast<std::uint32_t>(
        tile_forward(splats_.data(), {cuts_.data(), more_planes()}, list_.data() + begin,
                     tile_begin_[tile_index + 1] - begin, static_cast<float>(tx * kTileSize),
                     static_cast<float>(ty * kTileSize), limits, tile));
    for_tile_pixels(image_, tx, ty, [&](int at, size_t pixel) {
      float* splats = &alone.data[pixel * 4];
      splats[0] = tile.r[at];
      splats[1] = tile.g[at];
      splats[2] = tile.b[at];
      splats[3] = 1.0f - tile.t[at];
      float* picture = &image_.data[pixel * 4];
      if (!is_whole) {
        const float share = share_of(pixel);
        std::transform(splats, splats + 4, picture, [&](float v) { return share * v; });
        splats = picture;
      }
      if (front != nullptr) {
        put_behind(&front_.data[pixel * 4], splats, picture);
      }
    });
  });
  return image_;
}

void Rasterizer::backward(const Gaussians& gaussians, const Image& image_gradient,
                          Gaussians& gradients) {
  if (more_planes() > 0) {
    throw Error("gradients are there for one plane only, not for {}", planes_.size());
  }
  const TileLimits limits = limits_of(options_);
  const Image& alone = front_.data.empty() && share_.is_whole() ? image_ : alone_;
  instance_gradients_.resize(list_.size());
  parallel_for(used_.size(), 1, [&](size_t tile_index, size_t) {
    const int tx = static_cast<int>(tile_index) % tiles_x_;
    const int ty = static_cast<int>(tile_index) / tiles_x_;
    Tile before;
    start(tx, ty, before);
    Tile tile = before;
    Tile gradient{};
    for_tile_pixels(image_, tx, ty, [&](int at, size_t pixel) {
      const float* in = &alone.data[pixel * 4];
      const float* g = &image_gradient.data[pixel * 4];
      const float share = share_of(pixel);
      std::array<float, 4> behind;
      if (!front_.data.empty()) {
        const std::array<float, 4> shown = {share * in[0], share * in[1], share * in[2],
                                            share * in[3]};
        put_behind_backward(&front_.data[pixel * 4], shown.data(), g, behind.data());
        g = behind.data();
      }
      tile.r[at] = in[0];
      tile.g[at] = in[1];
      tile.b[at] = in[2];
      tile.t[at] = 1.0f - in[3];
      gradient.r[at] = share * g[0];
      gradient.g[at] = share * g[1];
      gradient.b[at] = share * g[2];
      gradient.t[at] = share * g[3];
    });
    const std::uint32_t begin = tile_begin_[tile_index];
    const std::uint32_t used = used_[tile_index];
    tile_backward(splats_.data(), list_.data() + begin, slots_.data() + begin, used,
                  static_cast<float>(tx * kTileSize), static_cast<float>(ty * kTileSize), limits,
                  before, tile, gradient, instance_gradients_.data());
    for (std::uint32_t k = begin + used; k < tile_begin_[tile_index + 1]; ++k) {
      instance_gradients_[slots_[k]] = {};
    }
  });
  // In index order, so that memory is walked forwards: the planes are far apart.
  has_gradient_.assign(gaussians.size(), 0);
  // Summed piece by piece, in order: the same at any number of threads.
  std::vector<Vec3> gain_gradients((gaussians.size() + kGaussianGrain - 1) / kGaussianGrain,
                                   Vec3(0));
  parallel_for(gaussians.size(), kGaussianGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (visible_[i] == 0) {
        continue;
      }
      const std::uint32_t k = rank_[i];
      const SplatGradient gradient = summed_gradient(k);
      if (gradient.h != 0 || gradient.r != 0 || gradient.g != 0 || gradient.b != 0) {
        gain_gradients[begin / kGaussianGrain] += project_backward(
            gaussians, i, camera_, planes_, options_, splats_[k], gradient, gradients);
        has_gradient_[i] = 1;
      }
    }
  });
  gain_gradient_ = Vec3(0);
  for (const Vec3& gradient : gain_gradients) {
    gain_gradient_ += gradient;
  }
  reached_.clear();
  for (size_t i = 0; i < gaussians.size(); ++i) {
    if (has_gradient_[i] != 0) {
      reached_.push_back(static_cast<std::uint32_t>(i));
    }
  }
}

/// Empty, but finished where nothing behind what is in front can be seen.
void Rasterizer::start(int tx, int ty, Tile& tile) const {
  tile = Tile{};
  std::fill(tile.t, tile.t + kTilePixels, 1.0f);
  if (front_.data.empty()) {
    return;
  }
  for_tile_pixels(front_, tx, ty, [&](int at, size_t pixel) {
    if (front_.data[pixel * 4 + 3] >= kOpaqueFace) {
      tile.t[at] = 0;
    }
  });
}

SplatGradient Rasterizer::summed_gradient(std::uint32_t splat) const {
  SplatGradient sum{};
  for (std::uint32_t slot = slot_begin_[splat]; slot < slot_begin_[splat + 1]; ++slot) {
    const SplatGradient& g = instance_gradients_[slot];
    sum.h += g.h;
    sum.hx += g.hx;
    sum.hy += g.hy;
    sum.hxx += g.hxx;
    sum.hxy += g.hxy;
    sum.hyy += g.hyy;
    sum.r += g.r;
    sum.g += g.g;
    sum.b += g.b;
    sum.e += g.e;
    sum.ex += g.ex;
    sum.ey += g.ey;
  }
  return sum;
}

}  // namespace clipgs
