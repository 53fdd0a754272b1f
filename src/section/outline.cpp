#include "section/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "section/face_rays.h"

namespace clipgs {
namespace {

constexpr float kStepVoxels = 0.4f;  // of the section: steps where there may be matter
constexpr float kLeastTransmittance = 1.0f / 256;
constexpr double kReferenceStepVoxels = 0.02;

/// The part of a ray, mm from the eye, that planes and the section's box leave.
template <typename T>
struct Span {
  T enter = 0;
  T leave = std::numeric_limits<T>::max();

  /// Leaves what lies at `distance` + t·`slope` ≥ 0.
  void keep(T distance, T slope) {
    if (slope > 0) {
      enter = std::max(enter, -distance / slope);
    } else if (slope < 0) {
      leave = std::min(leave, -distance / slope);
    } else if (distance < 0) {
      leave = enter;
    }
  }
};

template <typename T, typename V>
Span<T> kept_span(const Section& section, std::span<const Plane> planes, const V& eye,
                  const V& direction, const V& origin, const V& stride) {
  Span<T> span;
  for (const Plane& plane : planes) {
    const V normal(plane.normal);
    span.keep(glm::dot(normal, eye) - plane.offset, glm::dot(normal, direction));
  }
  for (int k = 0; k < 3; ++k) {
    span.keep(origin[k], stride[k]);
    span.keep(static_cast<T>(section.dims[k] - 1) - origin[k], -stride[k]);
  }
  return span;
}

}  // namespace

Outline::Outline(const Section& section, const EmptySpace& empty_space, const Camera& camera,
                 const Cut& cut)
    : section_(section),
      empty_space_(empty_space),
      materials_(section),
      camera_(camera),
      planes_(cut.planes().begin(), cut.planes().end()),
      origin_(section.index_from_world(camera.position)),
      step_(kStepVoxels * mean_spacing(section.spacing)) {
  for (int k = 0; k < 3; ++k) {
    index_from_direction_[k] = section.direction[k] / section.spacing[k];
  }
}

float Outline::along(float x, float y) const {
  const Vec3 direction = camera_.ray_direction(x, y);
  const Vec3 stride = direction * index_from_direction_;
  const auto [enter, leave] =
      kept_span<float>(section_, planes_, camera_.position, direction, origin_, stride);
  float transmittance = 1;
  for (float t = enter; t < leave;) {
    const float leap = empty_space_.leap(origin_ + t * stride, stride);
    if (leap > 0) {
      t += leap;
      continue;
    }
    const float length = std::min(step_, leave - t);
    const Vec3 sampled = section_.sample(origin_ + (t + 0.5f * length) * stride);
    transmittance *= std::exp(-materials_.of_value(section_.value(sampled)).extinction * length);
    if (transmittance < kLeastTransmittance) {
      return 1;
    }
    t += step_;
  }
  return 1 - transmittance;
}

float Outline::of_pixel(int x, int y) const {
  float sum = 0;
  for (int i = 0; i < kRays; ++i) {
    const Vec2 at = Vec2(x, y) + place_in_pixel(i, kRays);
    sum += along(at.x, at.y);
  }
  return sum / kRays;
}

void draw_outline(Image& picture, const Image* faces, const Outline& outline) {
  constexpr float kLeastBeyond = 1e-3f;  // of a face: less has no colour of its own
  parallel_for(static_cast<size_t>(picture.height), 4, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < picture.width; ++x) {
        float* const pixel = picture.at(x, y);
        const Vec4 face = faces != nullptr ? Vec4(faces->at(x, y)[0], faces->at(x, y)[1],
                                                  faces->at(x, y)[2], faces->at(x, y)[3])
                                           : Vec4(0);
        const float alpha = pixel[3];
        if (alpha < Outline::kLeastAlpha || alpha > Outline::kMostAlpha ||
            alpha - face.a < kLeastBeyond) {
          continue;
        }
        const float covered = std::max(face.a, outline.of_pixel(x, y));
        pixel[3] = covered;
        for (int c = 0; c < 3 && covered > 0; ++c) {
          const float color =
              std::clamp((alpha * pixel[c] - face[c]) / (alpha - face.a), 0.0f, 1.0f);
          pixel[c] = (face[c] + (covered - face.a) * color) / covered;
        }
      }
    }
  });
}

double outline_reference(const Section& section, const Camera& camera, const Cut& cut, double x,
                         double y) {
  using V = glm::dvec3;
  const V local((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
  const V direction = glm::normalize(local * glm::dmat3(camera.rotation));
  const V eye(camera.position);
  const auto index = [&](const V& offset) {
    return (offset * glm::dmat3(section.direction)) / V(section.spacing);
  };
  const V origin = index(eye - V(section.origin));
  const V stride = index(direction);
  const auto [enter, leave] =
      kept_span<double>(section, cut.planes(), eye, direction, origin, stride);
  const double step = kReferenceStepVoxels * mean_spacing(section.spacing);
  double depth = 0;
  for (double t = enter; t < leave; t += step) {
    const double length = std::min(step, leave - t);
    const Vec3 sampled = section.sample(Vec3(origin + (t + 0.5 * length) * stride));
    const float code = section.curve.code(section.value(sampled));
    const auto low = std::min(static_cast<size_t>(code), ValueCurve::kCodes - 2);
    depth += length *
             mix(section.materials[low], section.materials[low + 1], code - static_cast<float>(low))
                 .extinction;
  }
  return 1 - std::exp(-depth);
}

}  // namespace clipgs
