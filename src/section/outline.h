#pragma once

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
  static constexpr int kRays = 4;
  /// Splats that cover less of a pixel lend it no colour, and those that cover more are believed.
  static constexpr float kLeastAlpha = 0.005f;
  static constexpr float kMostAlpha = 0.995f;

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
/// pixel in part (Outline::kLeastAlpha to kMostAlpha), their colour is kept, and what they cover
/// beyond the face is what the section does.
void draw_outline(Image& picture, const Image* faces, const Outline& outline);

/// Outline::along() in double precision by many small steps: what it is held to.
double outline_reference(const Section& section, const Camera& camera, const Cut& cut, double x,
                         double y);

}  // namespace clipgs
