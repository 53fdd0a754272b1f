#include "tour/region.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clipgs {

namespace {

using glm::dvec2;
using glm::dvec3;

/// Samples within a region, about: fewer where it has few voxels.
constexpr double kMostSamples = 20'000;
constexpr double kLeastSamples = 400;

/// A region in its own plane, mm from its first point.
struct FlatRegion {
  dvec3 origin;
  dvec3 u;
  dvec3 v;
  std::vector<dvec2> corners;    ///< of an outline; of a circle, of the square around it
  std::optional<double> radius;  ///< of a circle

  bool contains(const dvec2& at) const {
    if (radius) {
      return glm::dot(at, at) <= *radius * *radius;
    }
    bool inside = false;
    for (size_t i = 0; i < corners.size(); ++i) {
      const dvec2& a = corners[i];
      const dvec2& b = corners[(i + 1) % corners.size()];
      if ((a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) * (b.x - a.x) / (b.y - a.y)) {
        inside = !inside;
      }
    }
    return inside;
  }
};

FlatRegion flatten(const Mark& region) {
  FlatRegion flat;
  flat.origin = region.points[0];
  const dvec3& normal = region.normal;
  const dvec3 aside = std::abs(normal.z) < 0.9 ? dvec3(0, 0, 1) : dvec3(1, 0, 0);
  flat.u = glm::normalize(glm::cross(aside, normal));
  flat.v = glm::cross(normal, flat.u);
  if (region.kind == MarkKind::kRegion) {
    const double r = glm::distance(flat.origin, region.points[1]);
    flat.radius = r;
    flat.corners = {{-r, -r}, {r, -r}, {r, r}, {-r, r}};
    return flat;
  }
  for (const dvec3& point : region.points) {
    const dvec3 from = point - flat.origin;
    flat.corners.emplace_back(glm::dot(from, flat.u), glm::dot(from, flat.v));
  }
  return flat;
}

double area_of(const FlatRegion& flat) {
  if (flat.radius) {
    return std::numbers::pi * *flat.radius * *flat.radius;
  }
  double twice = 0;
  for (size_t i = 0; i < flat.corners.size(); ++i) {
    const dvec2& here = flat.corners[i];
    const dvec2& next = flat.corners[(i + 1) % flat.corners.size()];
    twice += here.x * next.y - next.x * here.y;
  }
  return std::abs(twice) / 2;
}

}  // namespace

double region_area(const Mark& region) { return area_of(flatten(region)); }

std::optional<RegionValues> region_values(const Mark& region, const Section& section) {
  const FlatRegion flat = flatten(region);
  dvec2 low = flat.corners[0];
  dvec2 high = low;
  for (const dvec2& corner : flat.corners) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  const double area = (high.x - low.x) * (high.y - low.y);
  const Vec3& spacing = section.spacing;
  const double voxel = std::min({spacing.x, spacing.y, spacing.z});
  const double step = std::max(std::min(0.5 * voxel, std::sqrt(area / kLeastSamples)),
                               std::sqrt(area / kMostSamples));
  if (!(step > 0)) {
    return std::nullopt;
  }
  double samples = 0;
  double sum = 0;
  double squares = 0;
  double first = 0;  // values are summed from here: less is lost to rounding
  // The same sums as the page's: a sample at the edge is in both, or in neither.
  // NOLINTBEGIN(clang-analyzer-security.FloatLoopCounter)
  for (double y = low.y + 0.5 * step; y < high.y; y += step) {
    for (double x = low.x + 0.5 * step; x < high.x; x += step) {
      // NOLINTEND(clang-analyzer-security.FloatLoopCounter)
      if (!flat.contains({x, y})) {
        continue;
      }
      const auto reading = section.read(Vec3(flat.origin + x * flat.u + y * flat.v));
      if (reading) {
        first = samples == 0 ? static_cast<double>(reading->value) : first;
        const double value = static_cast<double>(reading->value) - first;
        ++samples;
        sum += value;
        squares += value * value;
      }
    }
  }
  if (samples == 0) {
    return std::nullopt;
  }
  const double offset = sum / samples;
  const double variance = std::max(0.0, squares / samples - offset * offset);
  return RegionValues{first + offset, std::sqrt(variance)};
}

}  // namespace clipgs
