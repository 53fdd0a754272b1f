#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace clipgs {

/// 256 values, ascending, that stand for many: a scalar quantiser.
struct Codebook {
  std::array<float, 256> values{};

  /// Index of the value nearest to `x`.
  std::uint8_t nearest(float x) const;
};

/// The quantiser of least squared error that Lloyd's iteration (Lloyd 1982) finds from levels laid
/// out by the cube root of the samples' density (Panter & Dite 1951). At most 256 different samples
/// are kept as they are. `samples` are finite; none gives a codebook of zeros. Their order does not
/// matter.
Codebook fit_codebook(std::vector<float> samples);

}  // namespace clipgs
