#pragma once

#include <vector>

#include "core/geometry.h"

namespace clipgs {

/// What matter of one value looks like.
struct Material {
  Vec3 albedo{0};          ///< single-scattering albedo, linear RGB, 0…1
  float extinction = 0;    ///< σ_t, 1/mm
  float specular = 0;      ///< weight of the GGX lobe of surface scattering, 0…1
  float roughness = 0.5f;  ///< GGX α of that lobe, (0, 1]
  float phase = 0;         ///< Henyey–Greenstein g of volume scattering, (−1, 1): the mean cosine
};

/// One control point; between points materials are interpolated linearly, beyond the ends they are
/// constant.
struct TransferPoint {
  float value = 0;  ///< HU, or the volume's stored unit
  Material material;
};

/// Value → material, sampled once into a table for speed.
class TransferFunction {
 public:
  TransferFunction() = default;
  /// `points` in any order, at least one; throws Error for non-finite or negative extinctions.
  explicit TransferFunction(std::vector<TransferPoint> points);

  /// Nearest table entry (kTableSize entries over [min_value, max_value]).
  const Material& at(float value) const { return table_[index(value)]; }
  /// Largest and smallest extinction that `at` returns for any value in [low, high]: right for
  /// non-monotonic functions too.
  float max_extinction(float low, float high) const;
  float min_extinction(float low, float high) const;

  float min_value() const { return min_value_; }
  float max_value() const { return max_value_; }
  const std::vector<TransferPoint>& points() const { return points_; }

  static constexpr int kTableSize = 4096;

 private:
  int index(float value) const {
    const float t = (value - min_value_) * scale_ + 0.5f;
    return t < 0 ? 0 : t >= kTableSize ? kTableSize - 1 : static_cast<int>(t);
  }

  std::vector<TransferPoint> points_;
  std::vector<Material> table_;
  // Sparse tables (level k: the maximum/minimum over 2^k entries) answer range queries in O(1).
  std::vector<std::vector<float>> max_levels_;
  std::vector<std::vector<float>> min_levels_;
  float min_value_ = 0;
  float max_value_ = 0;
  float scale_ = 0;
};

}  // namespace clipgs
