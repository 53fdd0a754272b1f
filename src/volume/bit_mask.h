#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/parallel.h"

namespace clipgs {

/// Yes or no for every voxel, an eighth of a byte each.
class BitMask {
 public:
  /// All no.
  explicit BitMask(size_t size) : size_(size), words_((size + 63) / 64, 0) {}

  size_t size() const { return size_; }
  bool operator[](size_t i) const { return (words_[i / 64] >> (i % 64) & 1U) != 0; }
  void set(size_t i) { words_[i / 64] |= bit(i); }
  void clear(size_t i) { words_[i / 64] &= ~bit(i); }
  /// The next yes at or after i; size() if there is none.
  size_t next(size_t i) const;
  size_t count() const;
  /// The 64 from i on, the first as the lowest bit; no beyond the end.
  std::uint64_t word(size_t i) const;
  /// Sets those of the 64 from i on whose bits are 1. Threads may set different ones.
  void set_word(size_t i, std::uint64_t bits);
  BitMask inverted() const;

  /// Sets each i of [begin, end) where decide(i). Threads may fill ranges that do not overlap.
  template <typename Decide>
  void fill(size_t begin, size_t end, const Decide& decide);
  /// combine(word, other's word) on 64 voxels at once; both masks have the same size.
  template <typename Combine>
  void combine(const BitMask& other, const Combine& combine);

 private:
  static std::uint64_t bit(size_t i) { return std::uint64_t{1} << (i % 64); }

  size_t size_;
  std::vector<std::uint64_t> words_;  // beyond size_: 0
};

inline size_t BitMask::next(size_t i) const {
  if (i >= size_) {
    return size_;
  }
  size_t word = i / 64;
  std::uint64_t left = words_[word] & (~std::uint64_t{0} << (i % 64));
  while (left == 0) {
    if (++word == words_.size()) {
      return size_;
    }
    left = words_[word];
  }
  return 64 * word + static_cast<size_t>(std::countr_zero(left));
}

inline size_t BitMask::count() const {
  size_t sum = 0;
  for (const std::uint64_t word : words_) {
    sum += static_cast<size_t>(std::popcount(word));
  }
  return sum;
}

inline std::uint64_t BitMask::word(size_t i) const {
  if (i >= size_) {
    return 0;
  }
  const size_t shift = i % 64;
  std::uint64_t bits = words_[i / 64] >> shift;
  if (shift > 0 && i / 64 + 1 < words_.size()) {
    bits |= words_[i / 64 + 1] << (64 - shift);
  }
  return bits;
}

inline void BitMask::set_word(size_t i, std::uint64_t bits) {
  const auto join = [this](size_t word, std::uint64_t more) {
    if (more != 0) {
      std::atomic_ref(words_[word]).fetch_or(more, std::memory_order_relaxed);
    }
  };
  const size_t shift = i % 64;
  join(i / 64, bits << shift);
  if (shift > 0) {
    join(i / 64 + 1, bits >> (64 - shift));
  }
}

inline BitMask BitMask::inverted() const {
  BitMask result(size_);
  for (size_t w = 0; w < words_.size(); ++w) {
    result.words_[w] = ~words_[w];
  }
  if (size_ % 64 != 0) {
    result.words_.back() &= bit(size_) - 1;
  }
  return result;
}

template <typename Decide>
void BitMask::fill(size_t begin, size_t end, const Decide& decide) {
  for (size_t i = begin; i < end;) {
    const size_t word = i / 64;
    const size_t stop = std::min(end, 64 * (word + 1));
    std::uint64_t bits = 0;
    for (; i < stop; ++i) {
      bits |= decide(i) ? bit(i) : 0;
    }
    // The ends of two threads' ranges may lie in one word.
    std::atomic_ref(words_[word]).fetch_or(bits, std::memory_order_relaxed);
  }
}

template <typename Combine>
void BitMask::combine(const BitMask& other, const Combine& combine) {
  for (size_t i = 0; i < words_.size(); ++i) {
    words_[i] = combine(words_[i], other.words_[i]);
  }
}

/// A mask of the i where decide(i), which may run on many threads.
template <typename Decide>
BitMask mask_where(size_t size, const Decide& decide) {
  BitMask mask(size);
  parallel_for(size, size_t{1} << 18,
               [&](size_t begin, size_t end) { mask.fill(begin, end, decide); });
  return mask;
}

inline BitMask both(BitMask a, const BitMask& b) {
  a.combine(b, [](std::uint64_t x, std::uint64_t y) { return x & y; });
  return a;
}

inline BitMask without(BitMask a, const BitMask& b) {
  a.combine(b, [](std::uint64_t x, std::uint64_t y) { return x & ~y; });
  return a;
}

}  // namespace clipgs
