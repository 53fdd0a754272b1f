#include "section/openings.h"

#include <algorithm>
#include <cmath>

namespace clipgs {
namespace {

// Of steps along a ray, in mean voxels of the traced volume: where there may be matter, and through
// it, where they grow.
constexpr float kSearch = 1;
constexpr float kFine = 0.25f;
constexpr float kGrowth = 1.2f;
constexpr int kFineSteps = 12;
constexpr int kSearchSteps = 256;  // leaps included
// From here on the rest is this wall's …
constexpr float kOpaqueWall = 1.0f / 32;
// … and of matter that takes less light than this nothing is seen.
constexpr float kWisp = 0.3f;

constexpr int kBounces = 10;
constexpr int kQuickBounces = 2;

// Of a surface's light: what no change of lights takes away, for lamps without some colour.
constexpr float kDim = 0.001f;
constexpr float kMostGain = 10;

/// How a section changes around a point.
struct Change {
  Vec3 slope;       // towards larger codes, RAS, any length
  float steepness;  // of the values, per mm
};

/// Differences over a voxel of the traced volume, as the path tracer takes them.
Change change_at(const Section& section, const Vec3& index) {
  Vec3 codes;
  Vec3 values;
  for (int k = 0; k < 3; ++k) {
    Vec3 step(0);
    step[k] = section.source_spacing[k] / section.spacing[k];
    const float above = section.code(index + step);
    const float below = section.code(index - step);
    const float width = 2 * section.source_spacing[k];
    codes[k] = (above - below) / width;
    values[k] = (section.curve.value(above) - section.curve.value(below)) / width;
  }
  return {section.direction * codes, glm::length(values)};
}

}  // namespace

Openings::Openings(const Section& section) : Openings(section, scan_surfaces(section)) {}

Openings::Openings(const Section& section, const SurfaceScan& scan)
    : materials_(section.materials),
      empty_space_(find_empty_space(section)),
      translucent_(scan.points.empty() ? 1 : scan.translucent),
      // What is not drawn needs no horizons.
      light_(make_cut_light(section,
                            drawn() ? std::span(scan.points) : std::span<const SurfacePoint>(),
                            section.rig)),
      own_light_(light_.solve({}, kBounces)) {}

std::vector<Vec3> Openings::solve(std::span<const Plane> planes, std::span<const Vec3> from) const {
  return light_.solve(planes, from.empty() ? kBounces : kQuickBounces, from);
}

FaceMaterial Openings::material_of(float code) const {
  const size_t low = std::min(static_cast<size_t>(code), ValueCurve::kCodes - 2);
  return mix(materials_[low], materials_[low + 1], code - static_cast<float>(low));
}

std::optional<Wall> Openings::first_wall(const Section& section, const Vec3& eye,
                                         const Vec3& direction, float from, float to) const {
  const float voxel = mean_spacing(section.source_spacing);
  const Vec3 origin = section.index_from_world(eye);
  const Vec3 stride = (direction * section.direction) / section.spacing;
  float t = from;
  for (int i = 0; i < kSearchSteps && t < to; ++i) {
    const Vec3 at = origin + t * stride;
    const float leap = empty_space_.leap(at, stride);
    if (leap > 0) {
      t += leap;
      continue;
    }
    if (material_of(section.code(at)).extinction <= 0) {
      t += kSearch * voxel;
      continue;
    }
    // Matter began within the last step.
    Vec3 sum(0);
    Vec3 steep_sum(0);
    float depth = 0;
    float transmittance = 1;
    float length = kFine * voxel;
    t = std::max(from, t - kSearch * voxel);
    for (int k = 0; k < kFineSteps && transmittance > kOpaqueWall; ++k) {
      const Vec3 at_middle = origin + (t + 0.5f * length) * stride;
      const FaceMaterial material = material_of(section.code(at_middle));
      const float weight = transmittance * (1 - std::exp(-material.extinction * length));
      const Vec3 tint = section.channels == 3 ? photo_albedo(section.sample(at_middle)) : Vec3(1);
      sum += weight * material.surface * tint;
      steep_sum += weight * material.boundary * tint;
      depth += weight * (t + 0.5f * length);
      transmittance -= weight;
      t += length;
      length *= kGrowth;
    }
    const float alpha = 1 - transmittance;
    if (alpha < kWisp) {
      continue;
    }
    const Change change = change_at(section, origin + depth / alpha * stride);
    const float share = section.steep ? section.steep->share(change.steepness) : 0;
    Wall wall{eye + depth / alpha * direction, -direction, glm::mix(sum, steep_sum, share) / alpha};
    const float length_of_slope = glm::length(change.slope);
    if (length_of_slope > 0) {
      const float facing = glm::dot(change.slope, direction);
      wall.normal = (facing > 0 ? -1.0f : 1.0f) / length_of_slope * change.slope;
    }
    return wall;
  }
  return std::nullopt;
}

OpenedLight::OpenedLight(const Openings& openings, const Cut& cut)
    : openings_(openings), solution_(openings.solve(cut.planes())) {}

Vec3 OpenedLight::on(const Wall& wall) const {
  return light_at(openings_.light().patches(), solution_, wall.position, wall.normal);
}

Vec3 OpenedLight::gain(const Vec3& world, const Vec3& axis) const {
  const Patches& patches = openings_.light().patches();
  const std::vector<Vec3>& own = openings_.own_light();
  Vec3 before(0);
  Vec3 now(0);
  for (const Vec3& side : {axis, -axis}) {
    patches.interpolate(world, side, [&](size_t patch, float weight) {
      if (openings_.is_lit(patch)) {
        before += weight * own[patch];
        now += weight * solution_[patch];
      }
    });
  }
  if (!(before.g > 0)) {
    return Vec3(1);
  }
  return glm::clamp((now + kDim * before.g) / (before + kDim * before.g), Vec3(1 / kMostGain),
                    Vec3(kMostGain));
}

}  // namespace clipgs
