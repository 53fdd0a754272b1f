#pragma once

#include <array>
#include <cstdint>

namespace clipgs {

/// Random numbers of a path. Its first dimensions are Sobol's sequence in two dimensions at a time,
/// shuffled and scrambled after Owen for every key and pair of dimensions (Burley 2020): the
/// samples of one key are spread evenly over every pair. All further ones are a small PCG's.
/// Everything is a function of (key, index): no state is shared.
namespace path_draws {

/// In pairs: dimensions 2n and 2n + 1 are even together.
enum Dimension : std::uint32_t {
  kPixelX,
  kPixelY,
  kDistance,
  kSurface,
  kAngle,
  kTurn,
  kDiscU,
  kDiscV,
  kKey,
  kLobe,
  kAngle2,
  kTurn2,
  kDistance2,
  kTexel,
  kLensU,
  kLensV,
};

/// Multipliers of `hash` (found by Wellons' search for low bias).
inline constexpr std::uint32_t kHash1 = 0x7feb352dU;
inline constexpr std::uint32_t kHash2 = 0x846ca68bU;
/// 2³² over the golden ratio: spreads counters before they are hashed.
inline constexpr std::uint32_t kGolden = 0x9e3779b9U;

inline std::uint32_t hash(std::uint32_t x) {
  x = (x ^ (x >> 16U)) * kHash1;
  x = (x ^ (x >> 15U)) * kHash2;
  return x ^ (x >> 16U);
}

/// Multipliers of a permutation in which every bit depends on lower ones alone (Laine and Karras
/// 2011, constants by Vegdahl).
inline constexpr std::array<std::uint32_t, 3> kPermute = {0x3d20adeaU, 0x05526c56U, 0x53a22864U};

/// Owen's scrambling of a fraction whose bits are reversed.
inline std::uint32_t permute(std::uint32_t x, std::uint32_t seed) {
  x = (x ^ (x * kPermute[0])) + seed;
  x = x * ((seed >> 16U) | 1U);
  x = x ^ (x * kPermute[1]);
  return x ^ (x * kPermute[2]);
}

inline std::uint32_t reverse_bits(std::uint32_t x) {
  std::uint32_t result = 0;
  for (int i = 0; i < 32; ++i) {
    result = result << 1U | (x >> static_cast<unsigned>(i) & 1U);
  }
  return result;
}

/// Sobol's second dimension at an index, bits reversed (the first one is the index itself): the
/// index as a polynomial in x, taken at 1 + x.
inline std::uint32_t sobol2(std::uint32_t index) {
  index ^= (index & 0xaaaaaaaaU) >> 1U;
  index ^= (index & 0xccccccccU) >> 2U;
  index ^= (index & 0xf0f0f0f0U) >> 4U;
  index ^= (index & 0xff00ff00U) >> 8U;
  return index ^ (index & 0xffff0000U) >> 16U;
}

/// Uniform in [0, 1).
inline float draw(Dimension dimension, std::uint32_t key, std::uint32_t index) {
  const std::uint32_t pair = hash(key + (dimension / 2 + 1) * kGolden);
  const std::uint32_t shuffled = reverse_bits(permute(reverse_bits(index), pair));
  const std::uint32_t at = dimension % 2 == 0 ? shuffled : sobol2(shuffled);
  const std::uint32_t scrambled = permute(at, hash(pair + dimension % 2 + 1));
  return static_cast<float>(reverse_bits(scrambled) >> 8U) * 0x1p-24f;
}

}  // namespace path_draws
}  // namespace clipgs
