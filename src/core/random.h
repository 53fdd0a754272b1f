#pragma once

#include <cstdint>

namespace clipgs {

/// PCG32 (O'Neill 2014): small, fast, and with independent streams, so that every pixel, frame or
/// training step gets its own sequence and results do not depend on the number of threads.
class Rng {
 public:
  explicit Rng(std::uint64_t seed, std::uint64_t stream = 0) : increment_((mix(stream) << 1) | 1) {
    next();
    state_ += mix(seed);
    next();
  }

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + increment_;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
  }

  /// Uniform in [0, 1).
  float uniform() { return static_cast<float>(next() >> 8) * 0x1p-24f; }
  /// Uniform in [0, n); n > 0.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(next()) * n) >> 32);
  }
  /// Standard normal (Box–Muller, one of the pair).
  float normal();

  /// A bijective 64-bit hash (SplitMix64's finaliser).
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
  }

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
};

}  // namespace clipgs
