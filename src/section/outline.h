#pragma once

#include <algorithm>
#include <vector>

#include "light/empty_space.h"

#include "core/camera.h"
#include "core/cut.h"
#include "core/image.h"
#include "section/material_table.h"
#include "section/section.h"

namespace clipgs {

/// Where matter ends in a picture (method.md §8): splats are round and soft there, a section knows
/// it to a fraction of its voxels.
class Outline {
 public:
  /// Rays of a pixel that are asked.
  static constexpr int kRays = 8;
  /// How much the section has to say where splats cover `alpha` of a pixel, 0…1: those that cover
  /// next to nothing lend it no colour, and those that cover all of it are believed. Not at once:
  /// pixels that are hardly told apart must look alike.
  static float share(float alpha) {
    constexpr Vec2 kLeast(0.002f, 0.01f);
    constexpr Vec2 kMost(0.97f, 0.999f);
    return std::clamp((alpha - kLeast.x) / (kLeast.y - kLeast.x), 0.0f, 1.0f) *
           std::clamp((kMost.y - alpha) / (kMost.y - kMost.x), 0.0f, 1.0f);
  }

  /// What `cut` keeps of a section, as `camera` sees it. `section` and `empty_space`, which is the
  /// section's (find_empty_space()), must outlive it.
  Outline(const Section& section, const EmptySpace& empty_space, const Camera& camera,
          const Cut& cut);

  /// How much of the light along the ray through image coordinates (x, y) matter takes, 0…1: what
  /// the path tracer's pictures have as alpha.
  float along(float x, float y) const;
  /// The mean over kRays rays of a pixel.
  float of_pixel(int x, int y) const;

 private:
  const Section& section_;
  const EmptySpace& empty_space_;
  MaterialTable materials_;
  Camera camera_;
  std::vector<Plane> planes_;
  Vec3 origin_;                // the camera, section's index
  Mat3 index_from_direction_;  // a row vector times this: mm to section's voxels
  float step_;                 // mm
};

/// Gives what splats show in a picture the outline of the section. `picture`: straight alpha, of
/// splats behind `faces` (premultiplied; null: none) as put_behind() has them. Where splats cover a
/// pixel in part (Outline::share()), all that is covered is what the section does. Of what faces
/// leave, the colour is `surface`'s (Tint::forward(); null: none) where there is one, also without
/// any splats, and the splats' elsewhere.
/// `grey`: faces show values, which may be there without matter, and cover as much as they did.
void draw_outline(Image& picture, const Image* faces, const Outline& outline,
                  const Image* surface = nullptr, bool grey = false);

/// Outline::along() in double precision by many small steps: what it is held to.
double outline_reference(const Section& section, const Camera& camera, const Cut& cut, double x,
                         double y);

}  // namespace clipgs
