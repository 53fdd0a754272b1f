#include "volume/slice_flood.h"

#include <algorithm>
#include <cstdint>

#include "core/parallel.h"

namespace clipgs {
namespace {

constexpr size_t kWord = 64;

/// What bits of `from` reach of `free` beside them within a word, by steps of 1, 2, 4, … (the
/// Kogge-Stone fill of chess programs). All of `from` are free.
template <typename Shift>
std::uint64_t filled(std::uint64_t from, std::uint64_t free, const Shift& shift) {
  for (unsigned step = 1; step < kWord; step *= 2) {
    from |= free & shift(from, step);
    free &= shift(free, step);
  }
  return from;
}

/// One slice, 64 voxels a word, rows beginning with a word each.
class Slice {
 public:
  Slice(int width, int height)
      : width_(static_cast<size_t>(width)),
        height_(static_cast<size_t>(height)),
        words_((width_ + kWord - 1) / kWord),
        free_(words_ * height_),
        reached_(words_ * height_) {}

  size_t words() const { return words_; }
  /// Where the flood may pass, of a row; beyond its end nothing is.
  std::uint64_t* free(size_t row) { return &free_[row * words_]; }
  const std::uint64_t* reached(size_t row) const { return &reached_[row * words_]; }

  void flood() {
    std::ranges::fill(reached_, 0);
    const size_t last = (width_ - 1) / kWord;
    const std::uint64_t end = std::uint64_t{1} << ((width_ - 1) % kWord);
    for (size_t row = 0; row < height_; ++row) {
      std::uint64_t* const to = &reached_[row * words_];
      const std::uint64_t* const from = free(row);
      if (row == 0 || row + 1 == height_) {
        std::copy_n(from, words_, to);
      } else {
        to[0] |= from[0] & 1U;
        to[last] |= from[last] & end;
        fill_row(row);
      }
    }
    // Down and up, until neither finds more.
    for (bool more = true; more;) {
      more = false;
      for (size_t row = 1; row < height_; ++row) {
        more |= pass(row - 1, row);
      }
      for (size_t row = height_ - 1; row > 0; --row) {
        more |= pass(row, row - 1);
      }
    }
  }

 private:
  /// Lets a row into one beside it; whether anything came.
  bool pass(size_t from, size_t to) {
    const std::uint64_t* const there = reached(from);
    std::uint64_t* const here = &reached_[to * words_];
    std::uint64_t came = 0;
    for (size_t w = 0; w < words_; ++w) {
      const std::uint64_t next = here[w] | (there[w] & free(to)[w]);
      came |= next ^ here[w];
      here[w] = next;
    }
    if (came != 0) {
      fill_row(to);
    }
    return came != 0;
  }

  /// Along a row, both ways.
  void fill_row(size_t row) {
    std::uint64_t* const here = &reached_[row * words_];
    const std::uint64_t* const open = free(row);
    std::uint64_t before = 0;  // of the word that was passed
    for (size_t w = 0; w < words_; ++w) {
      here[w] = filled(here[w] | (before >> (kWord - 1) & open[w]), open[w],
                       [](std::uint64_t x, unsigned step) { return x << step; });
      before = here[w];
    }
    before = 0;
    for (size_t w = words_; w-- > 0;) {
      here[w] = filled(here[w] | (before << (kWord - 1) & open[w]), open[w],
                       [](std::uint64_t x, unsigned step) { return x >> step; });
      before = here[w];
    }
  }

  size_t width_, height_, words_;
  std::vector<std::uint64_t> free_, reached_;  // [height, words]
};

std::uint64_t inside(size_t voxels) {
  return voxels >= kWord ? ~std::uint64_t{0} : (std::uint64_t{1} << voxels) - 1;
}

}  // namespace

BitMask flood_slices(const IVec3& dims, const BitMask& mask) {
  BitMask result(mask.size());
  const auto width = static_cast<size_t>(dims.x);
  const auto height = static_cast<size_t>(dims.y);
  parallel_for(static_cast<size_t>(dims.z), 1, [&](size_t z, size_t) {
    Slice slice(dims.x, dims.y);
    const auto place = [&](size_t y, size_t w) { return (z * height + y) * width + w * kWord; };
    for (size_t y = 0; y < height; ++y) {
      for (size_t w = 0; w < slice.words(); ++w) {
        slice.free(y)[w] = ~mask.word(place(y, w)) & inside(width - w * kWord);
      }
    }
    slice.flood();
    for (size_t y = 0; y < height; ++y) {
      for (size_t w = 0; w < slice.words(); ++w) {
        result.set_word(place(y, w), slice.reached(y)[w]);
      }
    }
  });
  return result;
}

std::vector<std::uint8_t> flood_slices(const IVec3& dims, const std::vector<std::uint8_t>& mask) {
  BitMask bits(mask.size());
  parallel_for(mask.size(), size_t{1} << 18, [&](size_t begin, size_t end) {
    bits.fill(begin, end, [&](size_t i) { return mask[i] != 0; });
  });
  const BitMask flooded = flood_slices(dims, bits);
  std::vector<std::uint8_t> reached(mask.size());
  parallel_for(reached.size(), size_t{1} << 18, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      reached[i] = flooded[i] ? 1 : 0;
    }
  });
  return reached;
}

}  // namespace clipgs
