#include "volume/phantom_paint.h"

#include "core/random.h"

namespace clipgs::phantom {

std::vector<Segment> tube(const std::vector<Vec3>& points, float radius_a, float radius_b) {
  std::vector<Segment> segments;
  const auto radius = [&](size_t i) {
    return glm::mix(radius_a, radius_b,
                    static_cast<float>(i) / static_cast<float>(points.size() - 1));
  };
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    segments.push_back({points[i], points[i + 1], radius(i), radius(i + 1)});
  }
  return segments;
}

std::vector<Segment> smooth_tube(std::vector<Vec3> points, float radius_a, float radius_b) {
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<Vec3> cut{points.front()};
    for (size_t i = 0; i + 1 < points.size(); ++i) {
      cut.push_back(glm::mix(points[i], points[i + 1], 0.25f));
      cut.push_back(glm::mix(points[i], points[i + 1], 0.75f));
    }
    cut.push_back(points.back());
    points = std::move(cut);
  }
  return tube(points, radius_a, radius_b);
}

std::vector<Segment> grown(std::vector<Segment> segments, float growth) {
  for (Segment& s : segments) {
    s.radius_a = std::max(s.radius_a + growth, 0.0f);
    s.radius_b = std::max(s.radius_b + growth, 0.0f);
  }
  return segments;
}

Box bounds_of(const std::vector<Segment>& segments) {
  Box box;
  for (const Segment& s : segments) {
    const Vec3 r(std::max(s.radius_a, s.radius_b));
    box.add(glm::min(s.a, s.b) - r);
    box.add(glm::max(s.a, s.b) + r);
  }
  return box;
}

float Painter::noise(const Vec3& p, float wavelength, std::uint32_t field) const {
  const Vec3 q = p / wavelength + 1000.0f;
  const Vec3 cell = glm::floor(q);
  Vec3 t = q - cell;
  t = t * t * (3.0f - 2.0f * t);
  const IVec3 c(cell);
  const auto corner = [&](int dx, int dy, int dz) {
    std::uint64_t key = seed_ * 64 + field;
    key = key * 4096 + static_cast<std::uint64_t>(c.x + dx);
    key = key * 4096 + static_cast<std::uint64_t>(c.y + dy);
    key = key * 4096 + static_cast<std::uint64_t>(c.z + dz);
    return static_cast<float>(Rng::mix(key) >> 40U) * 0x1p-23f - 1.0f;
  };
  const auto edge = [&](int dy, int dz) {
    return glm::mix(corner(0, dy, dz), corner(1, dy, dz), t.x);
  };
  return glm::mix(glm::mix(edge(0, 0), edge(1, 0), t.y), glm::mix(edge(0, 1), edge(1, 1), t.y),
                  t.z);
}

Painter::Range Painter::range_of(const Box& box) const {
  // The phantom's axes are the world's: no rotation. Half a voxel more holds the soft edge.
  const Vec3 low = volume_.index_from_world(box.min) - 0.5f;
  const Vec3 high = volume_.index_from_world(box.max) + 0.5f;
  return {glm::max(IVec3(glm::floor(low)), IVec3(0)),
          glm::min(IVec3(glm::floor(high)) + 1, volume_.dims)};
}

Box Painter::stretched_bounds(const std::vector<Segment>& segments, const Vec3& stretch) {
  Box box;
  for (const Segment& s : segments) {
    const Vec3 r = std::max(s.radius_a, s.radius_b) / stretch;
    box.add(glm::min(s.a, s.b) - r);
    box.add(glm::max(s.a, s.b) + r);
  }
  return box;
}

void Painter::slice_distances(const std::vector<Segment>& segments, const Vec3& stretch,
                              const Range& range, int z, std::vector<float>& distances) const {
  std::ranges::fill(distances, 1e9f);
  const auto width = static_cast<size_t>(range.high.x - range.low.x);
  for (const Segment& s : segments) {
    const Range own = range_of(stretched_bounds({s}, stretch));
    if (z < own.low.z || z >= own.high.z) {
      continue;
    }
    const Segment scaled{s.a * stretch, s.b * stretch, s.radius_a, s.radius_b};
    for (int y = own.low.y; y < own.high.y; ++y) {
      for (int x = own.low.x; x < own.high.x; ++x) {
        const Vec3 p = volume_.world_from_index(Vec3(x, y, z)) * stretch;
        float& d = distances[static_cast<size_t>(y - range.low.y) * width +
                             static_cast<size_t>(x - range.low.x)];
        d = std::min(d, distance_to(scaled, p));
      }
    }
  }
}

}  // namespace clipgs::phantom
