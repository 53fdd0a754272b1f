#include "volume/dilate.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr size_t kWord = 64;

/// A mask whose rows begin with a word each, so that they are joined word by word.
class Rows {
 public:
  Rows(const IVec3& dims, const BitMask& mask)
      : dims_(dims),
        words_((static_cast<size_t>(dims.x) + kWord - 1) / kWord),
        bits_(words_ * dims.y * dims.z),
        empty_(static_cast<size_t>(dims.y) * dims.z) {
    parallel_for(empty_.size(), 256, [&](size_t begin, size_t end) {
      for (size_t row = begin; row < end; ++row) {
        std::uint64_t any = 0;
        for (size_t w = 0; w < words_; ++w) {
          bits_[row * words_ + w] = mask.word(row * dims.x + w * kWord) & inside(w);
          any |= bits_[row * words_ + w];
        }
        empty_[row] = any == 0 ? 1 : 0;
      }
    });
  }

  size_t words() const { return words_; }
  /// Those bits of word `w` of a row that are voxels.
  std::uint64_t inside(size_t w) const {
    const size_t left = static_cast<size_t>(dims_.x) - w * kWord;
    return left >= kWord ? ~std::uint64_t{0} : (std::uint64_t{1} << left) - 1;
  }
  /// Adds row (y, z), if there is one, to `sum`; false if it has nothing to add.
  bool add_to(std::uint64_t* sum, int y, int z) const {
    if (y < 0 || y >= dims_.y || z < 0 || z >= dims_.z) {
      return false;
    }
    const size_t row = static_cast<size_t>(z) * dims_.y + static_cast<size_t>(y);
    if (empty_[row] != 0) {
      return false;
    }
    const std::uint64_t* const from = &bits_[row * words_];
    for (size_t w = 0; w < words_; ++w) {
      sum[w] |= from[w];
    }
    return true;
  }

 private:
  IVec3 dims_;
  size_t words_;                     // a row
  std::vector<std::uint64_t> bits_;  // [nz, ny, words]
  std::vector<std::uint8_t> empty_;  // [nz, ny]
};

/// The rows of a ball that reach equally far along x, from the farthest on: element i those that
/// reach i voxels.
std::vector<std::vector<glm::ivec2>> rows_of_ball(const IVec3& dims, const Vec3& spacing,
                                                  float radius) {
  const auto reach = [&](int axis) {  // spacings may be tiny
    return static_cast<int>(std::min(radius / spacing[axis], static_cast<float>(dims[axis] - 1)));
  };
  const auto square = [&](int axis, int steps) {
    return spacing[axis] * spacing[axis] * static_cast<float>(steps * steps);
  };
  const IVec3 most(reach(0), reach(1), reach(2));
  std::vector<std::vector<glm::ivec2>> rows(static_cast<size_t>(most.x) + 1);
  for (int z = -most.z; z <= most.z; ++z) {
    for (int y = -most.y; y <= most.y; ++y) {
      int x = most.x;
      while (x >= 0 && square(0, x) + square(1, y) + square(2, z) > radius * radius) {
        --x;
      }
      if (x >= 0) {
        rows[static_cast<size_t>(x)].emplace_back(y, z);
      }
    }
  }
  return rows;
}

/// Adds to every voxel of a row those beside it.
void spread(std::vector<std::uint64_t>& row) {
  std::uint64_t before = 0;
  for (size_t w = 0; w < row.size(); ++w) {
    const std::uint64_t here = row[w];
    const std::uint64_t after = w + 1 < row.size() ? row[w + 1] : 0;
    row[w] = here | here << 1 | here >> 1 | before >> (kWord - 1) | after << (kWord - 1);
    before = here;
  }
}

}  // namespace

// Rows that reach equally far are joined first, and then spread together: from the farthest on,
// voxel by voxel.
BitMask dilated(const IVec3& dims, const Vec3& spacing, const BitMask& mask, float radius) {
  const Rows rows(dims, mask);
  const std::vector<std::vector<glm::ivec2>> ball = rows_of_ball(dims, spacing, radius);
  BitMask result(mask.size());
  parallel_for(static_cast<size_t>(dims.y) * dims.z, 64, [&](size_t begin, size_t end) {
    std::vector<std::uint64_t> sum(rows.words());
    for (size_t row = begin; row < end; ++row) {
      const auto y = static_cast<int>(row % static_cast<size_t>(dims.y));
      const auto z = static_cast<int>(row / static_cast<size_t>(dims.y));
      std::ranges::fill(sum, 0);
      bool any = false;
      for (size_t x = ball.size(); x-- > 0;) {
        if (any) {
          spread(sum);
        }
        for (const glm::ivec2& at : ball[x]) {
          any |= rows.add_to(sum.data(), y + at.x, z + at.y);
        }
      }
      for (size_t w = 0; w < sum.size() && any; ++w) {
        result.set_word(row * dims.x + w * kWord, sum[w] & rows.inside(w));
      }
    }
  });
  return result;
}

BitMask eroded(const IVec3& dims, const Vec3& spacing, const BitMask& mask, float radius) {
  return dilated(dims, spacing, mask.inverted(), radius).inverted();
}

}  // namespace clipgs
