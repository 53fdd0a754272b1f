#include "section/openings.h"

#include <algorithm>
#include <cmath>

namespace clipgs {
namespace {

// Of steps along a ray, in mean voxels of the traced volume: where there may be matter, …
constexpr float kSearch = 0.5f;
constexpr int kSearchSteps = 512;  // leaps included
// … to its beginning, by halves, and through it, where they grow. What is seen must not depend on
// where a step happens to end: it would show as rings around whatever is nearly flat.
constexpr int kHalvings = 3;
constexpr float kFine = 0.1f;
constexpr float kGrowth = 1.3f;
constexpr int kFineSteps = 12;
// From here on the rest is this wall's …
constexpr float kOpaqueWall = 1.0f / 32;
// … and of matter that takes less light than this nothing is seen.
constexpr float kWisp = 0.3f;

// Values rise into matter, or, where a surface would be seen from within by more than this cosine,
// out of it. At a rim a normal that is turned towards the camera might look into the body.
constexpr float kGrazing = 0.25f;

constexpr int kBounces = 10;
constexpr int kQuickBounces = 2;

// Of a surface's light: what no change of lights takes away, for lamps without some colour.
constexpr float kDim = 0.001f;
constexpr float kMostGain = 10;

}  // namespace

Openings::Openings(const Section& section) : Openings(section, scan_surfaces(section)) {}

Openings::Openings(const Section& section, const SurfaceScan& scan)
    : materials_(section),
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

std::optional<Wall> Openings::first_wall(const Section& section, const Vec3& eye,
                                         const Vec3& direction, float from, float to) const {
  const float voxel = mean_spacing(section.source_spacing);
  const Vec3 origin = section.index_from_world(eye);
  const Vec3 stride = (direction * section.direction) / section.spacing;
  const auto material_at = [&](const Vec3& sampled) -> const FaceMaterial& {
    return materials_.of_value(section.value(sampled));
  };
  const auto is_matter = [&](float t) {
    return material_at(section.sample(origin + t * stride)).extinction > 0;
  };
  float t = from;
  float begin = from;  // nothing before is looked at again
  for (int i = 0; i < kSearchSteps && t < to; ++i) {
    const float leap = empty_space_.leap(origin + t * stride, stride);
    if (leap > 0) {
      t += leap;
      continue;
    }
    if (!is_matter(t)) {
      t += kSearch * voxel;
      continue;
    }
    float before = std::max(begin, t - kSearch * voxel);
    for (int k = 0; k < kHalvings; ++k) {
      const float middle = 0.5f * (before + t);
      (is_matter(middle) ? t : before) = middle;
    }
    t = before;
    FaceMaterial seen{.roughness = 0};  // sums
    float depth = 0;
    float transmittance = 1;
    float length = kFine * voxel;
    for (int k = 0; k < kFineSteps && transmittance > kOpaqueWall; ++k) {
      const Vec3 sampled = section.sample(origin + (t + 0.5f * length) * stride);
      const FaceMaterial& material = material_at(sampled);
      if (material.extinction <= 0 && transmittance < 1) {
        break;  // what is seen beyond a gap is another wall
      }
      const float weight = transmittance * (1 - std::exp(-material.extinction * length));
      const Vec3 tint = section.channels == 3 ? photo_albedo(sampled) : Vec3(1);
      seen.surface += weight * material.surface * tint;
      seen.boundary += weight * material.boundary * tint;
      seen.specular += weight * material.specular;
      seen.roughness += weight * material.specular * material.roughness;
      depth += weight * (t + 0.5f * length);
      transmittance -= weight;
      t += length;
      length *= kGrowth;
    }
    const float alpha = 1 - transmittance;
    if (alpha < kWisp) {
      t += length;
      begin = t;
      continue;
    }
    const Vec3 slope = gradient_at(section, origin + depth / alpha * stride);
    const float steepness = glm::length(slope);
    const float share = section.steep ? section.steep->share(steepness) : 0;
    Wall wall{eye + depth / alpha * direction, -direction,
              glm::mix(seen.surface, seen.boundary, share) / alpha, seen.specular / alpha,
              seen.specular > 0 ? seen.roughness / seen.specular : 1};
    if (steepness > 0) {
      const bool away = glm::dot(slope, direction) < -kGrazing * steepness;
      wall.normal = (away ? 1.0f : -1.0f) / steepness * slope;
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
      if (Openings::is_lit(own[patch])) {
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
