#pragma once

#include <array>
#include <cstdint>
#include <numbers>

namespace clipgs {

/// Random numbers of a path. Its first dimensions run through an additive recurrence (Richtmyer's
/// sequence, a random start for every key), which spreads the samples of one key evenly; all
/// further ones are a small PCG's. Everything is a function of (key, index): no state is shared.
namespace path_draws {

enum Dimension : std::uint32_t {
  kPixelX,
  kPixelY,
  kDistance,
  kSurface,
  kLobe,
  kAngle,
  kTurn,
  kKey,
  kDiscU,
  kDiscV,
  kDistance2,
  kAngle2,
  kTurn2,
  kLensU,
  kLensV,
  kTexel,
  kDimensions
};

/// Fractional parts of the square roots of primes, ·2³²: irrational and independent of each other.
constexpr std::array<std::uint32_t, kDimensions> steps() {
  constexpr std::array<double, kDimensions> kRoots = {
      std::numbers::sqrt2, std::numbers::sqrt3, 2.23606797749979,   2.6457513110645907,
      3.3166247903554,     3.605551275463989,   4.123105625617661,  4.358898943540674,
      4.795831523312719,   5.385164807134504,   5.5677643628300215, 6.082762530298219,
      6.4031242374328485,  6.557438524302,      6.855654600401044,  7.280109889280518};
  std::array<std::uint32_t, kDimensions> result{};
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double fraction = kRoots[i] - static_cast<int>(kRoots[i]);
    result[i] = static_cast<std::uint32_t>(fraction * 4294967296.0);
  }
  return result;
}
inline constexpr std::array<std::uint32_t, kDimensions> kSteps = steps();

/// Multipliers of `hash` (found by Wellons' search for low bias).
inline constexpr std::uint32_t kHash1 = 0x7feb352dU;
inline constexpr std::uint32_t kHash2 = 0x846ca68bU;
/// 2³² over the golden ratio: spreads counters before they are hashed.
inline constexpr std::uint32_t kGolden = 0x9e3779b9U;

constexpr std::uint32_t hash(std::uint32_t x) {
  x = (x ^ (x >> 16U)) * kHash1;
  x = (x ^ (x >> 15U)) * kHash2;
  return x ^ (x >> 16U);
}

/// Uniform in [0, 1).
constexpr float draw(Dimension dimension, std::uint32_t key, std::uint32_t index) {
  const std::uint32_t start = hash(key + (dimension + 1) * kGolden);
  return static_cast<float>((start + index * kSteps[dimension]) >> 8U) * 0x1p-24f;
}

}  // namespace path_draws
}  // namespace clipgs
