#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry.h"
#include "core/image.h"

namespace clipgs {

/// Light from all around, as an octahedral map (Engelhardt & Dachsbacher 2008) in the frame that
/// paths are traced in: a direction finds its texel without trigonometry. Radiance is constant in a
/// texel, so that directions can be drawn exactly in proportion to it.
class EnvironmentMap {
 public:
  static constexpr int kSide = 256;  ///< texels: 0.7° each

  /// `panorama` is [height, width, 3], linear, longitude over latitude with superior at the top and
  /// anterior in the middle; it is turned by `turn` radians towards the patient's right.
  EnvironmentMap(const Image& panorama, float turn, const Mat3& frame_from_world);

  /// Radiance from unit `direction`, linear RGB.
  Vec3 radiance(const Vec3& direction) const;
  /// (1/π)·∫ L(ω) max(0, n·ω) dω: what a white Lambert face radiates.
  Vec3 face_radiance(const Vec3& normal) const;

  /// Where a direction lies in the map, each coordinate in [0, 1].
  static Vec2 square_from_direction(const Vec3& direction);
  static Vec3 direction_from_square(const Vec2& at);

  /// [kSide · kSide] each, x fastest.
  struct Tables {
    std::array<std::vector<float>, 3> radiance;
    /// Probability density of drawn directions times (|x| + |y| + |z|)³, 1/sr: a texel's solid
    /// angle is 4/kSide² times that (to first order), so one number serves the whole texel.
    std::vector<float> density;
    /// Walker's alias method: texel i is kept with probability `keep`, else `alias` is taken.
    std::vector<float> keep;
    std::vector<std::int32_t> alias;
  };
  const Tables& tables() const { return tables_; }

 private:
  void make_alias_table(const std::vector<double>& power);

  Tables tables_;
  std::vector<std::array<Vec3, 3>> flux_;  // of blocks of texels: ∫ L ω dω for each channel
};

}  // namespace clipgs
