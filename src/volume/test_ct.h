#pragma once

#include "core/random.h"
#include "volume/volume.h"

namespace clipgs {

/// What a made-up patient shows at a point: HU at RAS mm from the middle of the picture.
using HuAt = float (*)(const Vec3&);

inline constexpr float kTestAir = -1000;

// mm, of pictures that hold them.
inline constexpr Vec3 kTrunkSize(420, 300, 300);
inline constexpr Vec3 kTallSize(420, 300, 480);
inline constexpr Vec3 kWholeSize(420, 300, 780);
inline constexpr Vec3 kHeadSize(240, 240, 240);

/// A CT of `size` (mm) in cubes of `spacing`, with the noise of a scanner.
inline Volume ct_of(HuAt hu, const Vec3& size, float spacing = 3) {
  Volume volume;
  volume.dims = IVec3(size / spacing);
  volume.spacing = Vec3(spacing);
  volume.modality = Modality::kCt;
  std::vector<float> values;
  values.reserve(volume.voxels());
  Rng rng(1);
  for (size_t i = 0; i < volume.voxels(); ++i) {
    const IVec3 voxel(i % volume.dims.x, i / volume.dims.x % volume.dims.y,
                      i / volume.offset(0, 0, 1));
    const Vec3 place = (Vec3(voxel) + 0.5f) * spacing - 0.5f * size;
    constexpr float kNoise = 24;  // HU, from end to end
    values.push_back(hu(place) + kNoise * (rng.uniform() - 0.5f));
  }
  volume.values = std::move(values);
  return volume;
}

/// Whether a point lies in an upright cylinder of these half axes.
inline bool in_cylinder(const Vec3& p, const Vec2& middle, const Vec2& radii) {
  const Vec2 at = (Vec2(p) - middle) / radii;
  return glm::dot(at, at) < 1;
}

/// Skin and fat, muscle, and a spine at the back whose marrow is bright and even.
inline float trunk_hu(const Vec3& p) {
  if (!in_cylinder(p, {0, 0}, {170, 115})) {
    return kTestAir;
  }
  if (in_cylinder(p, {0, -70}, {20, 20})) {
    return in_cylinder(p, {0, -70}, {14, 14}) ? 240.0f : 700.0f;
  }
  return in_cylinder(p, {0, 0}, {155, 100}) ? 50.0f : -100.0f;
}

inline float chest_hu(const Vec3& p) {
  const bool lung = in_cylinder(p, {75, 0}, {50, 75}) || in_cylinder(p, {-75, 0}, {50, 75});
  return lung ? -850 : trunk_hu(p);
}

/// Lungs above the middle, none below.
inline float chest_and_abdomen_hu(const Vec3& p) { return p.z > 0 ? chest_hu(p) : trunk_hu(p); }

inline bool in_aorta(const Vec3& p) { return in_cylinder(p, {-15, -35}, {13, 13}); }
inline float arterial_hu(const Vec3& p) { return in_aorta(p) ? 340 : trunk_hu(p); }
inline float venous_hu(const Vec3& p) { return in_aorta(p) ? 160 : trunk_hu(p); }

/// A brain in its skull above z = -30, a neck below.
inline float head_hu(const Vec3& p) {
  if (p.z < -30) {
    return in_cylinder(p, {0, -20}, {12, 12}) ? 500
           : in_cylinder(p, {0, 0}, {58, 58}) ? 50
                                              : kTestAir;
  }
  return !in_cylinder(p, {0, 0}, {76, 96})   ? kTestAir
         : !in_cylinder(p, {0, 0}, {71, 91}) ? 40.0f
         : !in_cylinder(p, {0, 0}, {64, 84}) ? 900.0f
                                             : 35.0f;
}

/// Arteries of the brain, 4 mm wide.
inline float head_angiography_hu(const Vec3& p) {
  const bool artery = in_cylinder(p, {25, 10}, {2, 2}) || in_cylinder(p, {-25, 10}, {2, 2}) ||
                      in_cylinder(p, {0, -20}, {2, 2}) || in_cylinder(p, {5, 30}, {2, 2});
  return artery && p.z > -30 ? 380 : head_hu(p);
}

inline float limb_hu(const Vec3& p) {
  return in_cylinder(p, {0, 0}, {15, 15})   ? 900.0f
         : in_cylinder(p, {0, 0}, {60, 60}) ? 50.0f
                                            : kTestAir;
}

/// Small, and much of it bone.
inline float wrist_hu(const Vec3& p) {
  return in_cylinder(p, {0, 0}, {12, 12})   ? 900.0f
         : in_cylinder(p, {0, 0}, {30, 30}) ? 50.0f
                                            : kTestAir;
}

/// A head on a trunk with lungs.
inline float whole_hu(const Vec3& p) {
  return p.z > 250 ? head_hu(p - Vec3(0, 0, 310)) : chest_and_abdomen_hu(p);
}

}  // namespace clipgs
