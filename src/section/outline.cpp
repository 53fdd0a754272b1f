#include "section/outline.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel.h"
#include "section/face_rays.h"
#include "section/kept_span.h"

namespace clipgs {
namespace {

constexpr float kMarchVoxels = 0.4f;    // of the section: steps where there may be matter
constexpr float kOpaqueDepth = 5.545f;  // optical: what goes through is less than 1/256
constexpr double kReferenceMarch = 0.02;

}  // namespace

Outline::Outline(const Section& section, const EmptySpace& empty_space, const Camera& camera,
                 const Cut& cut)
    : section_(section),
      empty_space_(empty_space),
      materials_(section),
      camera_(camera),
      planes_(cut.planes().begin(), cut.planes().end()),
      origin_(section.index_from_world(camera.position)),
      step_(kMarchVoxels * mean_spacing(section.spacing)) {
  for (int k = 0; k < 3; ++k) {
    index_from_direction_[k] = section.direction[k] / section.spacing[k];
  }
}

float Outline::along(float x, float y) const {
  const Vec3 direction = camera_.ray_direction(x, y);
  const Vec3 stride = direction * index_from_direction_;
  const auto [enter, leave, slope] =
      kept_span<float>(section_, planes_, camera_.position, direction, origin_, stride);
  // Leaps by whole steps: what is sampled does not depend on how they round.
  float depth = 0;  // optical
  for (float step = 0; enter + step * step_ < leave;) {
    const float begin = enter + step * step_;
    const float length = std::min(step_, leave - begin);
    const Vec3 at = origin_ + (begin + 0.5f * length) * stride;
    const float leap = empty_space_.leap(at, stride);
    if (leap > 0) {
      step += std::ceil(leap / step_);
      continue;
    }
    depth += length * materials_.of_value(section_.value(section_.sample(at))).extinction;
    if (depth > kOpaqueDepth) {
      return 1;
    }
    ++step;
  }
  return 1 - std::exp(-depth);
}

float Outline::of_pixel(int x, int y) const {
  float sum = 0;
  for (int i = 0; i < kRays; ++i) {
    const Vec2 at = Vec2(x, y) + place_in_pixel(i, kRays);
    sum += along(at.x, at.y);
  }
  return sum / kRays;
}

void draw_outline(Image& picture, const Image* faces, const Outline& outline, const Image* surface,
                  bool grey) {
  constexpr float kLeastBeyond = 1e-3f;  // of a face: less has no colour of its own
  constexpr float kSomeMatter = 0.01f;   // splats at a surface that they may not cover at all
  const auto at = [](const Image* image, int x, int y) {
    const float* const p = image != nullptr ? image->at(x, y) : nullptr;
    return p != nullptr ? Vec4(p[0], p[1], p[2], p[3]) : Vec4(0);
  };
  parallel_for(static_cast<size_t>(picture.height), 4, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < picture.width; ++x) {
        float* const pixel = picture.at(x, y);
        const float alpha = pixel[3];
        const Vec4 on_surface = at(surface, x, y);
        const bool has_surface = on_surface.a > 0;
        const float share = Outline::share(has_surface ? std::max(alpha, kSomeMatter) : alpha);
        if (share <= 0 && !has_surface) {
          continue;
        }
        const Vec4 face = at(faces, x, y);
        const float beyond = alpha - face.a;  // that splats cover
        const float matter = share > 0 ? outline.of_pixel(x, y) : alpha;
        const float covered = std::max(grey ? face.a : 0, glm::mix(alpha, matter, share));
        pixel[3] = covered;
        if (beyond < kLeastBeyond && !has_surface) {
          continue;  // all of it looks as the face does
        }
        const bool has_splats = beyond >= kLeastBeyond;
        // Where a ray more or less meets a surface, at its rim, must not be seen.
        const float seen = has_splats ? std::min(2 * on_surface.a, 1.0f) : 1;
        for (int c = 0; c < 3 && covered > 0; ++c) {
          const float splats =
              has_splats ? std::clamp((alpha * pixel[c] - face[c]) / beyond, 0.0f, 1.0f) : 0;
          const float color = glm::mix(splats, on_surface[c], seen);
          pixel[c] = covered > face.a ? (face[c] + (covered - face.a) * color) / covered
                                      : face[c] / face.a;
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
  const auto [enter, leave, slope] =
      kept_span<double>(section, cut.planes(), eye, direction, origin, stride);
  const double step = kReferenceMarch * mean_spacing(section.spacing);
  double depth = 0;
  const int steps = static_cast<int>(std::ceil(std::max(0.0, leave - enter) / step));
  for (int i = 0; i < steps; ++i) {
    const double t = enter + i * step;
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
