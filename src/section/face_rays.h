#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/camera.h"
#include "core/cut.h"
#include "section/material_table.h"
#include "section/section.h"

namespace clipgs {

/// One face as rays meet it.
struct Face {
  Vec3 outward;        ///< unit, RAS, towards the removed side
  float distance = 0;  ///< of the camera, mm; negative on the removed side
  Vec3 light;          ///< what a white face radiates, linear RGB
};

/// Where a ray runs through matter behind a face.
struct FaceRay {
  const Face* face = nullptr;
  Vec3 direction;   ///< unit, RAS
  Vec3 step;        ///< section's voxels per mm
  float enter = 0;  ///< mm from the camera
  float leave = 0;
};

/// What a ray met at a face.
struct March {
  float alpha = 0;
  std::optional<float> gap;  ///< mm from the camera
};

/// Where in a pixel ray `i` of `count` goes, 0…1: one through the middle, more of them spread by
/// the golden ratio, so that no two are in line with a side of the pixel and edges at any angle are
/// smooth.
inline Vec2 place_in_pixel(int i, int count) {
  constexpr float kGolden = 0.618034f;
  const float along = 0.5f + kGolden * static_cast<float>(i);
  return {along - std::floor(along), (static_cast<float>(i) + 0.5f) / static_cast<float>(count)};
}

/// Pixels from `low` to before `high`.
struct PixelBox {
  glm::ivec2 low{0};
  glm::ivec2 high{0};
};

/// The rays of one camera through the faces that planes expose, and through the section's ends:
/// what drawing a face and fitting its reflectances share.
class FaceRays {
 public:
  FaceRays(const Section& section, const Camera& camera, const Cut& cut, int taps);

  /// Whether the camera stands before any face.
  bool any() const;
  /// No ray outside these pixels meets a face.
  PixelBox covered() const;
  /// The ray through image coordinates (x, y), if it meets a face first.
  std::optional<FaceRay> through(float x, float y) const;

  /// Section's index of the point `t` mm from the camera.
  Vec3 index_at(const FaceRay& ray, float t) const { return origin_ + t * ray.step; }

  /// Calls use(ray) for those of `count` rays through pixel (x, y) that meet a face first.
  template <typename Use>
  void for_rays(int x, int y, int count, const Use& use) const {
    for (int i = 0; i < count; ++i) {
      const Vec2 at = Vec2(x, y) + place_in_pixel(i, count);
      if (const std::optional<FaceRay> ray = through(at.x, at.y)) {
        use(*ray);
      }
    }
  }

  /// Calls visit(weight, sampled, code, material, surface) for what the ray sees, from the face
  /// inwards: `sampled` is what Section::sample() returned, `code` that of its value, `weight` is
  /// transmittance times opacity, `surface` whether it is matter at the face. Returns alpha, and
  /// where, if anywhere, the matter that begins at the face ends in a gap.
  template <typename Visit>
  March march(const FaceRay& ray, const Visit& visit) const {
    constexpr float kLeastTransmittance = 1.0f / 256;
    const float slope = -glm::dot(ray.face->outward, ray.direction);
    float transmittance = 1;
    for (const Step& step : steps_) {
      const float t = ray.enter + step.middle;
      if (t > ray.leave) {
        break;
      }
      const bool surface = step.middle * slope < surface_depth_;
      const Vec3 sampled = section_.sample(index_at(ray, t));
      const size_t entry = materials_.entry_of(section_.value(sampled));
      const float alpha = step.alphas[entry];
      if (alpha <= 0 || (!surface && transmittance == 1)) {
        // Matter beyond a gap is another surface, with light of its own.
        if (!surface || transmittance < 1) {
          return {1 - transmittance, t};
        }
        continue;
      }
      const FaceMaterial& material = materials_[entry];
      const float code = materials_.code(entry);
      if (transmittance * (1 - alpha) < kLeastTransmittance) {
        // As good as opaque: the rest is this tissue's, so that nothing behind counts as seen.
        visit(transmittance, sampled, code, material, surface);
        return {1, std::nullopt};
      }
      visit(transmittance * alpha, sampled, code, material, surface);
      transmittance *= 1 - alpha;
    }
    // Along a ray that grazes the face, too, nothing at all is a gap.
    const float end = ray.enter + steps_.back().middle;
    return {1 - transmittance, transmittance == 1 ? std::optional(end) : std::nullopt};
  }

 private:
  /// A step of the march, mm: short at the face, where most is seen.
  struct Step {
    float length = 0;
    float middle = 0;
    std::vector<float> alphas;  // what a step through matter of each entry hides
  };

  void add_face(const Plane& plane);
  void plan_steps(int taps);
  /// The part of a face that the section's box and the other faces leave: a convex polygon, RAS mm.
  std::vector<Vec3> polygon_of(const Face& face) const;

  const Section& section_;
  float surface_depth_;  // mm below a face that count as the face itself
  Camera camera_;
  Vec3 origin_;                // the camera, section's index
  Mat3 index_from_direction_;  // a row vector times this: mm to section's voxels
  std::vector<Face> faces_;
  std::vector<Step> steps_;
  MaterialTable materials_;
};

}  // namespace clipgs
