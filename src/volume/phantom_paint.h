#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/geometry.h"
#include "core/parallel.h"
#include "volume/volume.h"

// What the phantom is drawn with: signed distances (mm, negative inside), smooth noise, and a
// painter that lays tissue over tissue with soft, partial-volume edges.
namespace clipgs::phantom {

/// Distance to an ellipsoid, to first order (exact on its surface).
inline float ellipsoid(const Vec3& p, const Vec3& center, const Vec3& radii) {
  const Vec3 q = (p - center) / radii;
  const float k = glm::length(q);
  const float slope = glm::length(q / radii);
  return slope > 1e-6f ? k * (k - 1) / slope : -std::min({radii.x, radii.y, radii.z});
}

inline float ellipse(const Vec2& p, const Vec2& center, const Vec2& radii) {
  const Vec2 q = (p - center) / radii;
  const float k = glm::length(q);
  const float slope = glm::length(q / radii);
  return slope > 1e-6f ? k * (k - 1) / slope : -std::min(radii.x, radii.y);
}

/// Part of a tube: a capsule whose radius changes linearly.
struct Segment {
  Vec3 a;
  Vec3 b;
  float radius_a;
  float radius_b;
};

inline float distance_to(const Segment& s, const Vec3& p) {
  const Vec3 along = s.b - s.a;
  const float t = std::clamp(glm::dot(p - s.a, along) / glm::dot(along, along), 0.0f, 1.0f);
  return glm::length(p - s.a - t * along) - glm::mix(s.radius_a, s.radius_b, t);
}

/// Union and intersection whose seam is rounded over about `k` mm (Quilez's polynomial).
inline float smooth_union(float a, float b, float k) {
  const float h = std::max(k - std::abs(a - b), 0.0f) / k;
  return std::min(a, b) - 0.25f * h * h * k;
}
inline float smooth_intersection(float a, float b, float k) { return -smooth_union(-a, -b, k); }

/// 0 below `low`, 1 above `high`, smooth between.
inline float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// A tube through all points, its radius from the first to the last value.
std::vector<Segment> tube(const std::vector<Vec3>& points, float radius_a, float radius_b);
/// The same, rounded: every corner of the path is cut twice (Chaikin).
std::vector<Segment> smooth_tube(std::vector<Vec3> points, float radius_a, float radius_b);
/// All radii larger by `growth` mm (smaller if negative).
std::vector<Segment> grown(std::vector<Segment> segments, float growth);
Box bounds_of(const std::vector<Segment>& segments);

/// Paints bodies into a volume, voxel by voxel.
class Painter {
 public:
  Painter(Volume& volume, std::uint64_t seed)
      : volume_(volume), values_(volume.values.unpack()), voxel_(volume.spacing.x), seed_(seed) {}

  /// Smooth noise in [−1, 1] that varies over `wavelength` mm; `field` tells independent ones
  /// apart.
  float noise(const Vec3& p, float wavelength, std::uint32_t field) const;

  /// Lays hu(p) over what is there, wherever distance(p) < 0, in the voxels of `box`.
  template <typename Distance, typename Hu>
  void paint(const Box& box, const Distance& distance, const Hu& hu) {
    const Range range = range_of(box);
    parallel_for(range.slices(), 1, [&](size_t begin, size_t end) {
      for (int z = range.low.z + static_cast<int>(begin); z < range.low.z + static_cast<int>(end);
           ++z) {
        for (int y = range.low.y; y < range.high.y; ++y) {
          for (int x = range.low.x; x < range.high.x; ++x) {
            const Vec3 p = volume_.world_from_index(Vec3(x, y, z));
            lay(x, y, z, distance(p), [&] { return hu(p); });
          }
        }
      }
    });
  }

  /// Lays hu(p) wherever one of the segments is; `stretch` scales space for flattened tubes.
  template <typename Hu>
  void paint_tubes(const std::vector<Segment>& segments, const Hu& hu,
                   const Vec3& stretch = Vec3(1)) {
    const Range range = range_of(stretched_bounds(segments, stretch));
    const size_t width = static_cast<size_t>(std::max(range.high.x - range.low.x, 0));
    const size_t rows = static_cast<size_t>(std::max(range.high.y - range.low.y, 0));
    parallel_for(range.slices(), 1, [&](size_t begin, size_t end) {
      std::vector<float> distances(width * rows);
      for (int z = range.low.z + static_cast<int>(begin); z < range.low.z + static_cast<int>(end);
           ++z) {
        slice_distances(segments, stretch, range, z, distances);
        for (int y = range.low.y; y < range.high.y; ++y) {
          for (int x = range.low.x; x < range.high.x; ++x) {
            const float d = distances[static_cast<size_t>(y - range.low.y) * width +
                                      static_cast<size_t>(x - range.low.x)];
            lay(x, y, z, d, [&] { return hu(volume_.world_from_index(Vec3(x, y, z))); });
          }
        }
      }
    });
  }

 private:
  /// Voxels [low, high).
  struct Range {
    IVec3 low;
    IVec3 high;
    size_t slices() const { return static_cast<size_t>(std::max(high.z - low.z, 0)); }
  };

  template <typename Hu>
  void lay(int x, int y, int z, float distance, const Hu& hu) {
    const float coverage = std::clamp(0.5f - distance / voxel_, 0.0f, 1.0f);
    if (coverage > 0) {
      float& value = values_[volume_.offset(x, y, z)];
      value = glm::mix(value, hu(), coverage);
    }
  }

  Range range_of(const Box& box) const;
  static Box stretched_bounds(const std::vector<Segment>& segments, const Vec3& stretch);
  void slice_distances(const std::vector<Segment>& segments, const Vec3& stretch,
                       const Range& range, int z, std::vector<float>& distances) const;

  Volume& volume_;
  std::vector<float>& values_;
  float voxel_;
  std::uint64_t seed_;
};

}  // namespace clipgs::phantom
