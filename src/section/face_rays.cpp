#include "section/face_rays.h"

#include <algorithm>
#include <limits>

#include "section/face_light.h"

namespace clipgs {
namespace {

constexpr float kDepthVoxels = 4;  // of the traced volume: what lies deeper is left to the splats

float mean_spacing(const Vec3& spacing) { return std::cbrt(spacing.x * spacing.y * spacing.z); }

FaceMaterial mix(const FaceMaterial& a, const FaceMaterial& b, float t) {
  return {glm::mix(a.extinction, b.extinction, t), glm::mix(a.specular, b.specular, t),
          glm::mix(a.roughness, b.roughness, t), glm::mix(a.surface, b.surface, t),
          glm::mix(a.interior, b.interior, t)};
}

/// The growth g with first·(g^count − 1)/(g − 1) = sum, for sum ≥ first·count.
float growth(float first, int count, float sum) {
  float low = 1;
  float high = 8;
  for (int i = 0; i < 40; ++i) {
    const float g = 0.5f * (low + high);
    float reached = 0;
    float length = first;
    for (int k = 0; k < count; ++k) {
      reached += length;
      length *= g;
    }
    (reached < sum ? low : high) = g;
  }
  return low;
}

}  // namespace

FaceRays::FaceRays(const Section& section, const Camera& camera, const Cut& cut, int taps)
    : section_(section),
      camera_(camera),
      origin_(section.index_from_world(camera.position)),
      low_(section.curve.values().front()),
      entries_per_value_((kEntries - 1) / (section.curve.values().back() - low_)) {
  for (int k = 0; k < 3; ++k) {
    index_from_direction_[k] = section.direction[k] / section.spacing[k];
  }
  for (const Plane& plane : cut.planes()) {
    add_face(plane);
  }
  for (const Plane& end : section.ends()) {
    add_face(end);
  }
  if (any()) {
    fill_materials();
    plan_steps(taps);
  }
}

void FaceRays::add_face(const Plane& plane) {
  faces_.push_back({-plane.normal, plane.signed_distance(camera_.position),
                    section_.surface_depth(plane.normal),
                    face_diffuse(section_.rig, -plane.normal)});
}

void FaceRays::plan_steps(int taps) {
  float most = 0;
  for (const FaceMaterial& material : section_.materials) {
    most = std::max(most, material.extinction);
  }
  const float depth = kDepthVoxels * mean_spacing(section_.source_spacing);
  float length = std::min(depth / static_cast<float>(taps), 0.5f / std::max(most, 1e-6f));
  const float factor = growth(length, taps, depth);
  float at = 0;
  for (int i = 0; i < taps; ++i) {
    Step step{length, at + 0.5f * length, {}};
    for (const FaceMaterial& material : materials_) {
      step.alphas.push_back(1 - std::exp(-material.extinction * length));
    }
    steps_.push_back(std::move(step));
    at += length;
    length *= factor;
  }
}

void FaceRays::fill_materials() {
  for (size_t i = 0; i < kEntries; ++i) {
    const float code = section_.curve.code(low_ + static_cast<float>(i) / entries_per_value_);
    const size_t low = std::min(static_cast<size_t>(code), ValueCurve::kCodes - 2);
    codes_.push_back(code);
    materials_.push_back(
        mix(section_.materials[low], section_.materials[low + 1], code - static_cast<float>(low)));
  }
}

bool FaceRays::any() const {
  return std::ranges::any_of(faces_, [](const Face& face) { return face.distance < 0; });
}

int FaceRays::samples_for_detail() const {
  const Vec3 center = section_.world_from_index(0.5f * Vec3(section_.dims - 1));
  const float pixel = glm::length(center - camera_.position) / camera_.fx;
  return std::clamp(static_cast<int>(std::ceil(pixel / mean_spacing(section_.spacing))), 1, 4);
}

std::optional<FaceRay> FaceRays::through(float x, float y) const {
  // Distances count in depths of the camera until it is known that the ray meets a face.
  const Vec3 direction =
      Vec3((x - camera_.cx) / camera_.fx, (y - camera_.cy) / camera_.fy, 1) * camera_.rotation;
  FaceRay ray;
  ray.leave = std::numeric_limits<float>::max();
  for (const Face& face : faces_) {
    const float slope = -glm::dot(face.outward, direction);
    const float t = -face.distance / slope;
    if (slope > 0) {
      if (t > ray.enter) {
        ray.enter = t;
        ray.face = &face;
      }
    } else if (slope < 0) {
      ray.leave = std::min(ray.leave, t);
    } else if (face.distance < 0) {
      return std::nullopt;
    }
  }
  if (ray.face == nullptr) {
    return std::nullopt;
  }
  ray.step = direction * index_from_direction_;
  const Vec3 at = origin_ + ray.enter * ray.step;
  for (int k = 0; k < 3; ++k) {
    const auto last = static_cast<float>(section_.dims[k] - 1);
    constexpr float kSlack = 1e-3f;  // voxels: a side may be the face
    if (at[k] < -kSlack || at[k] > last + kSlack) {
      return std::nullopt;  // in through a side of the box, not through the face
    }
    const float side = ray.step[k] > 0 ? last : 0;
    ray.leave = std::min(ray.leave, (side - origin_[k]) / ray.step[k]);
  }
  if (!(ray.enter < ray.leave)) {
    return std::nullopt;
  }
  const float length = glm::length(direction);
  ray.direction = direction / length;
  ray.step /= length;
  ray.enter *= length;
  ray.leave *= length;
  return ray;
}

}  // namespace clipgs
