#include "section/tint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace clipgs {
namespace {

// Of the half diagonal of a section: at 1024 pixels a block is about four wide.
constexpr float kBlockShare = 1.0f / 110;
constexpr float kMostBlock = 16;
// Of light: how much of the surface's own colour is believed beside the splats'. Where these show
// nothing of it, R is 1.
constexpr float kBelief = 0.1f;
// Splats of what was dark uncut become far too bright, and of any colour, in the light of a cut.
constexpr float kMostTint = 1.25f;

/// Of a block: the splats that lie on the surface, and the surface where there are splats.
struct Pair {
  Vec3 splats{0};
  Vec3 surface{0};
};

Vec4 color_at(const Image& image, size_t pixel) {
  const float* const p = &image.data[4 * pixel];
  return {p[0], p[1], p[2], p[3]};
}

/// Means of blocks, from the top left; pixels outside of the picture count as nothing.
class BlockMeans {
 public:
  BlockMeans(const Image& picture, const Image* faces, const Image& surface, int block)
      : block_(block),
        across_((picture.width + block - 1) / block),
        down_((picture.height + block - 1) / block),
        means_(static_cast<size_t>(across_) * down_) {
    parallel_for(static_cast<size_t>(down_), 4, [&](size_t begin, size_t end) {
      for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
        for (int column = 0; column < across_; ++column) {
          means_[static_cast<size_t>(row) * across_ + column] =
              mean_of(column, row, picture, faces, surface);
        }
      }
    });
  }

  /// Around a pixel: the mean of four bilinear samples half a block beside it.
  Pair around(int x, int y) const {
    const Taps columns = taps_at(x, across_);
    const Taps rows = taps_at(y, down_);
    Pair sum;
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) {
        const Pair& mean =
            means_[static_cast<size_t>(rows.blocks[r]) * across_ + columns.blocks[c]];
        const float weight = rows.weights[r] * columns.weights[c];
        sum.splats += weight * mean.splats;
        sum.surface += weight * mean.surface;
      }
    }
    return sum;
  }

 private:
  struct Taps {
    std::array<int, 3> blocks;
    std::array<float, 3> weights;
  };

  Taps taps_at(int pixel, int count) const {
    const float place = (static_cast<float>(pixel) + 0.5f) / static_cast<float>(block_);
    const int middle = static_cast<int>(place);
    const float share = place - static_cast<float>(middle);
    return {{std::max(middle - 1, 0), middle, std::min(middle + 1, count - 1)},
            {0.5f * (1 - share), 0.5f, 0.5f * share}};
  }

  Pair mean_of(int column, int row, const Image& picture, const Image* faces,
               const Image& surface) const {
    Pair sum;
    for (int y = row * block_; y < std::min((row + 1) * block_, picture.height); ++y) {
      for (int x = column * block_; x < std::min((column + 1) * block_, picture.width); ++x) {
        const size_t pixel = static_cast<size_t>(y) * picture.width + x;
        const Vec4 seen = color_at(surface, pixel);
        if (seen.a <= 0) {
          continue;
        }
        const Vec4 behind =
            color_at(picture, pixel) - (faces != nullptr ? color_at(*faces, pixel) : Vec4(0));
        const Vec4 splats = glm::max(behind, Vec4(0));
        sum.splats += seen.a * Vec3(splats);
        sum.surface += splats.a * seen.a * Vec3(seen);
      }
    }
    const auto pixels = static_cast<float>(block_ * block_);
    return {sum.splats / pixels, sum.surface / pixels};
  }

  int block_;
  int across_;
  int down_;
  std::vector<Pair> means_;
};

}  // namespace

int tint_block(const Section& section, const Camera& camera) {
  const Vec3 last(section.dims - 1);
  const float radius = 0.5f * glm::length(last * section.spacing);
  const float distance = glm::distance(camera.position, section.world_from_index(0.5f * last));
  const float side = kBlockShare * camera.fx * radius / std::max(distance, 0.01f * radius);
  return static_cast<int>(std::lround(std::clamp(side, 1.0f, kMostBlock)));
}

Image tinted(const Image& picture, const Image* faces, const Image& surface, int block) {
  const BlockMeans means(picture, faces, surface, block);
  Image out(picture.width, picture.height, 4);
  parallel_for(static_cast<size_t>(picture.height), 4, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const Vec4 seen = color_at(surface, static_cast<size_t>(y) * picture.width + x);
        if (seen.a > 0) {
          const auto [splats, own] = means.around(x, y);
          const Vec3 ratio = glm::min((splats + kBelief) / (own + kBelief), Vec3(kMostTint));
          const Vec4 color(glm::min(Vec3(seen) * ratio, Vec3(1)), seen.a);
          std::copy_n(&color[0], 4, out.at(x, y));
        }
      }
    }
  });
  return out;
}

}  // namespace clipgs
