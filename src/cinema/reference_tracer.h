#pragma once

#include "cinema/lights.h"
#include "cinema/path_tracer.h"
#include "core/camera.h"
#include "core/random.h"
#include "volume/preset.h"
#include "volume/volume.h"

namespace clipgs {

/// The same pictures as PathTracer's, computed the slow and obvious way: double precision, the
/// volume's own floats, one majorant for all of it, no Russian roulette, a shadow ray for every
/// light. For tests and benchmarks.
class ReferenceTracer {
 public:
  /// The volume and preset must outlive the tracer.
  ReferenceTracer(const Volume& volume, const Preset& preset, const Camera& camera, const Cut& cut,
                  int max_bounces);

  /// One path through image coordinates (x, y) in px.
  PathSample trace(float x, float y, Rng& rng) const;

 private:
  using DVec3 = glm::dvec3;
  struct Collision {
    double t = 0;
    double value = 0;
    LabelLook label;
  };

  template <typename Use>
  void interpolate(const DVec3& voxel, const Use& use) const;
  double value_at(const DVec3& voxel) const;
  DVec3 gradient_at(const DVec3& voxel) const;
  double extinction_at(const DVec3& voxel, double value, const LabelLook& label) const;
  Vec3 photo_at(const DVec3& voxel) const;
  LabelLook draw_label(const DVec3& voxel, Rng& rng) const;
  DVec3 voxel_at(const DVec3& origin, const DVec3& direction, double t) const {
    return origin + t * direction / spacing_;
  }
  bool clip(const DVec3& origin, const DVec3& direction, double& t0, double& t1) const;
  bool track(const DVec3& origin, const DVec3& direction, double t0, double t1, Rng& rng,
             Collision& collision) const;
  double visibility(const DVec3& voxel, const Vec3& direction, Rng& rng) const;
  double depth_below(size_t face, const DVec3& voxel) const;
  const Vec3* face_at(const DVec3& voxel, const DVec3& direction) const;
  bool is_behind_face(const DVec3& voxel, const DVec3& direction) const;
  Material material_at(const DVec3& voxel, double value, bool by_value_alone) const;

  const Volume& volume_;
  const Preset& preset_;
  std::vector<LabelLook> labels_;    // by the volume's indices; empty without labels
  std::vector<std::uint8_t> photo_;  // colours of matter; empty without
  Camera camera_;
  int max_bounces_;
  Lights lights_;
  DVec3 spacing_;
  double voxel_;  // side of a cube as large as a scanned voxel, mm
  DVec3 last_;    // voxel index of the far corner
  double majorant_;
  std::vector<Plane> planes_;  // in the grid frame: normal·(voxel·spacing) >= offset is kept
  std::vector<Vec3> outward_;  // of the faces: the planes', then the box's −x +x −y +y −z +z
};

}  // namespace clipgs
