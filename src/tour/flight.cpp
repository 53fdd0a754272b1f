#include "tour/flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clipgs {

namespace {

using glm::dvec3;

constexpr double kOutside = 1.05;  // radii of the sphere
constexpr double kOther = -0.5;    // cosine
constexpr double kCrossing = 1.0 / 3;
constexpr double kPole = 1e-4;
constexpr double kDegrees = 180 / std::numbers::pi;

double eased(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  return s * s * s * (10 + s * (6 * s - 15));
}

double mix(double from, double to, double share) { return from + (to - from) * share; }

/// Degrees, the shorter way round.
double mix_angle(double from, double to, double share) {
  const double way = std::fmod(std::fmod(to - from, 360.0) + 540, 360.0);
  return from + (way - 180) * share;
}

/// On the sphere, of unit vectors that are not opposite.
dvec3 slerp(const dvec3& from, const dvec3& to, double share) {
  const double angle = std::acos(std::clamp(glm::dot(from, to), -1.0, 1.0));
  if (angle < 1e-6) {
    return to;
  }
  return glm::normalize(std::sin((1 - share) * angle) * from + std::sin(share * angle) * to);
}

struct Angles {
  double azimuth;
  double elevation;
};

/// Of what a view shows: from above and below the picture lies as from the front.
Angles shown_angles(const ShownView& view) {
  const double azimuth = view.azimuth / kDegrees;
  const double elevation = view.elevation / kDegrees;
  const dvec3 direction(-std::sin(azimuth) * std::cos(elevation),
                        std::cos(azimuth) * std::cos(elevation), std::sin(elevation));
  if (std::hypot(direction.x, direction.y) < kPole) {
    return {0, direction.z > 0 ? 90.0 : -90.0};
  }
  if (std::abs(view.elevation) <= 90) {
    return {view.azimuth, view.elevation};
  }
  return {std::atan2(-direction.x, direction.y) * kDegrees, std::asin(direction.z) * kDegrees};
}

ShownView mix_view(const ShownView& from, const ShownView& to, double share) {
  const Angles here = shown_angles(from);
  const Angles there = shown_angles(to);
  const double zoomed = std::log(to.zoom / from.zoom);
  const double panned =
      std::abs(zoomed) < 1e-6 ? share : std::expm1(-share * zoomed) / std::expm1(-zoomed);
  return {mix_angle(here.azimuth, there.azimuth, share),
          mix(here.elevation, there.elevation, share), from.zoom * std::exp(share * zoomed),
          glm::mix(from.pan, to.pan, panned), mix(from.back, to.back, share)};
}

/// How far a plane is from the middle of the body, towards what it removes.
double distance_of(const ShownCut& cut, const Sphere& sphere) {
  return glm::dot(cut.normal, dvec3(sphere.center)) - cut.offset;
}

ShownCut cut_at(const dvec3& normal, double distance, std::optional<double> thickness,
                const Sphere& sphere) {
  return {normal, glm::dot(normal, dvec3(sphere.center)) - distance, thickness};
}

/// Of the same normal, and so far outside that it cuts nothing.
ShownCut outside(const ShownCut& cut, const Sphere& sphere) {
  const double beyond = kOutside * sphere.radius;
  const double far = std::max(beyond, distance_of(cut, sphere));
  return cut_at(cut.normal, far, cut.thickness ? std::optional(far + beyond) : std::nullopt,
                sphere);
}

/// Turns about the middle of the body.
ShownCut mix_cut(const ShownCut& from, const ShownCut& to, double share, const Sphere& sphere) {
  const double distance = mix(distance_of(from, sphere), distance_of(to, sphere), share);
  const std::optional<double> thickness =
      to.thickness ? std::optional(mix(*from.thickness, *to.thickness, share)) : std::nullopt;
  return cut_at(slerp(from.normal, to.normal, share), distance, thickness, sphere);
}

/// Whether the one becomes the other on the way.
bool are_one(const ShownCut& from, const ShownCut& to) {
  return from.thickness.has_value() == to.thickness.has_value() &&
         glm::dot(from.normal, to.normal) > kOther;
}

std::vector<ShownCut> mix_cuts(const std::vector<ShownCut>& from, const std::vector<ShownCut>& to,
                               double share, const Sphere& sphere) {
  const std::vector<ShownCut>& all = share < 0.5 ? from : to;
  std::vector<ShownCut> result;
  for (size_t i = 0; i < all.size(); ++i) {
    if (i < from.size() && i < to.size() && are_one(from[i], to[i])) {
      result.push_back(mix_cut(from[i], to[i], eased(share), sphere));
    } else {
      const double there = eased(std::abs(1 - 2 * share));
      result.push_back(mix_cut(outside(all[i], sphere), all[i], there, sphere));
    }
  }
  return result;
}

}  // namespace

Crossing crossing(double share) {
  return {1 - eased(share / kCrossing),
          std::clamp((share - kCrossing) / (1 - kCrossing), 0.0, 1.0)};
}

Shown flight(const Shown& from, const Shown& to, double share, const Sphere& sphere) {
  if (share <= 0 || share >= 1) {
    return share <= 0 ? from : to;
  }
  const double s = eased(share);
  Shown result = share < 0.5 ? from : to;
  result.view = mix_view(from.view, to.view, s);
  result.cuts = mix_cuts(from.cuts, to.cuts, share, sphere);
  result.grey = mix(from.grey, to.grey, s);
  result.turn = mix_angle(from.turn, to.turn, s);
  result.depth_cue = mix(from.depth_cue, to.depth_cue, s);
  if (from.window && to.window) {
    result.window = {mix(from.window->center, to.window->center, s),
                     mix(from.window->width, to.window->width, s)};
  } else {
    result.window = to.window ? to.window : from.window;
  }
  if (from.lamp && to.lamp && glm::dot(*from.lamp, *to.lamp) > kOther) {
    result.lamp = slerp(*from.lamp, *to.lamp, s);
  }
  return result;
}

}  // namespace clipgs
