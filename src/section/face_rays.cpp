#include "section/face_rays.h"

#include <algorithm>
#include <limits>

#include "section/face_light.h"

namespace clipgs {
namespace {

constexpr float kDepthVoxels = 4;  // of the traced volume: what lies deeper is left to the splats

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

/// The part of a convex polygon where distance(point) >= 0.
template <typename Distance>
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, const Distance& distance) {
  std::vector<Vec3> result;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const float da = distance(a);
    const float db = distance(b);
    if (da >= 0) {
      result.push_back(a);
    }
    if ((da >= 0) != (db >= 0)) {
      result.push_back(glm::mix(a, b, da / (da - db)));
    }
  }
  return result;
}

}  // namespace

FaceRays::FaceRays(const Section& section, const Camera& camera, const Cut& cut, int taps)
    : section_(section),
      surface_depth_(section.surface_depth()),
      camera_(camera),
      origin_(section.index_from_world(camera.position)),
      materials_(section) {
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
    plan_steps(taps);
  }
}

void FaceRays::add_face(const Plane& plane) {
  faces_.push_back({-plane.normal, plane.signed_distance(camera_.position),
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
    for (size_t entry = 0; entry < MaterialTable::kEntries; ++entry) {
      step.alphas.push_back(1 - std::exp(-materials_[entry].extinction * length));
    }
    steps_.push_back(std::move(step));
    at += length;
    length *= factor;
  }
}

bool FaceRays::any() const {
  return std::ranges::any_of(faces_, [](const Face& face) { return face.distance < 0; });
}

std::vector<Vec3> FaceRays::polygon_of(const Face& face) const {
  constexpr float kSlack = 0.01f;  // mm: a side of the box may be the face
  const Vec3 last(section_.dims - 1);
  const Vec3 center = section_.world_from_index(0.5f * last);
  const float reach = glm::length(last * section_.spacing);
  // How far a point lies from a face on the removed side.
  const auto above = [&](const Face& f, const Vec3& point) {
    return glm::dot(f.outward, point - camera_.position) - f.distance;
  };
  const Vec3 at = center - above(face, center) * face.outward;
  Vec3 u;
  Vec3 v;
  orthonormal_basis(face.outward, u, v);
  std::vector<Vec3> polygon = {at - reach * u - reach * v, at + reach * u - reach * v,
                               at + reach * u + reach * v, at - reach * u + reach * v};
  for (int k = 0; k < 3; ++k) {
    const auto along = [&](const Vec3& point) {
      return glm::dot(section_.direction[k], point - section_.origin);
    };
    const float length = last[k] * section_.spacing[k];
    polygon = clipped(polygon, [&](const Vec3& point) { return along(point) + kSlack; });
    polygon = clipped(polygon, [&](const Vec3& point) { return length - along(point) + kSlack; });
  }
  for (const Face& other : faces_) {
    polygon = clipped(polygon, [&](const Vec3& point) { return kSlack - above(other, point); });
  }
  return polygon;
}

PixelBox FaceRays::covered() const {
  constexpr float kNear = 1e-3f;  // mm
  const glm::ivec2 size(camera_.width, camera_.height);
  Vec2 low(size);
  Vec2 high(0);
  for (const Face& face : faces_) {
    for (const Vec3& corner : face.distance < 0 ? polygon_of(face) : std::vector<Vec3>()) {
      const Vec3 p = camera_.to_camera(corner);
      if (p.z < kNear) {
        return {glm::ivec2(0), size};
      }
      const Vec2 pixel(camera_.fx * p.x / p.z + camera_.cx, camera_.fy * p.y / p.z + camera_.cy);
      low = glm::min(low, pixel);
      high = glm::max(high, pixel);
    }
  }
  const Vec2 limit(size);
  return {glm::ivec2(glm::clamp(low - 1.0f, Vec2(0), limit)),
          glm::ivec2(glm::clamp(high + 2.0f, Vec2(0), limit))};
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
    if (ray.step[k] != 0) {
      const float side = ray.step[k] > 0 ? last : 0;
      ray.leave = std::min(ray.leave, (side - origin_[k]) / ray.step[k]);
    }
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
