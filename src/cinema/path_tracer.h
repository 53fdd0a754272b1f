#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "cinema/scene.h"
#include "core/camera.h"
#include "core/cut.h"
#include "core/random.h"

namespace clipgs {

/// Random numbers of one path. The first dimensions run through an additive recurrence (Richtmyer's
/// sequence, a random start per pixel), which spreads a pixel's samples evenly; all further ones
/// are PCG's.
class PathDraws {
 public:
  enum Dimension {
    kPixelX,
    kPixelY,
    kDistance,
    kSurface,
    kLobe,
    kAngle,
    kTurn,
    kKey,
    kDiscU,
    kDiscV,
    kDistance2,
    kAngle2,
    kTurn2,
    kLensU,
    kLensV,
    kDimensions
  };

  /// Sequence `stream` of `seed`; samples are numbered from `first`.
  PathDraws(std::uint64_t seed, std::uint64_t stream, std::uint32_t first);

  void next_sample() { ++index_; }
  float operator()(Dimension dimension) const {
    return static_cast<float>((starts_[dimension] + index_ * kSteps[dimension]) >> 8) * 0x1p-24f;
  }
  float uniform() { return rng_.uniform(); }
  Rng& rng() { return rng_; }

 private:
  static const std::array<std::uint32_t, kDimensions> kSteps;

  std::array<std::uint32_t, kDimensions> starts_;
  std::uint32_t index_;
  Rng rng_;
};

/// Light along one camera path. Where it misses, all is zero: the picture's background is empty.
struct PathSample {
  Vec3 radiance{0};
  bool hit = false;  ///< the camera ray met matter; its mean is the alpha
  Vec3 albedo{0};    ///< of the matter that the camera ray met
};

/// A thin lens. What is not at its focus is blurred.
struct Lens {
  float radius = 0;  ///< mm; 0: a pinhole, all is sharp
  float focus = 0;   ///< mm along the view's axis to the plane that is sharp
};

/// Unbiased volumetric path tracing (up to `max_bounces`) of one camera's view of what a cut keeps
/// of a scene: delta tracking against macrocell majorants, hybrid surface/phase scattering
/// after Exposure Render (Kroes 2012), next-event estimation of the key lights, the sky by
/// following the paths.
class PathTracer {
 public:
  PathTracer(const CinemaScene& scene, const Camera& camera, const Cut& cut, int max_bounces,
             const Lens& lens = {});

  /// One path through image coordinates (x, y) in px and a point of the lens.
  PathSample trace(float x, float y, PathDraws& draws) const;

  /// Median distance along the ray, mm, at which it first meets matter: where half of what the ray
  /// meets in all lies behind it. 0 where it meets nothing (alpha < 1/255).
  float first_hit(float x, float y) const;

 private:
  struct Ray {
    Vec3 origin;     // voxel space
    Vec3 direction;  // grid frame, unit
    Vec3 step;       // voxels per mm
    Vec3 inverse;    // mm per voxel, finite
  };
  struct Collision {
    float t = 0;  // mm
    float code = 0;
  };
  /// A flat face of the visible block: the cut, or a side of the volume's box.
  struct Face {
    Vec3 outward;   // grid frame
    Vec3 gradient;  // mm per voxel: depth in mm of p = offset − gradient·p
    float offset = 0;
    float half_voxel = 0;  // mm
    Vec3 radiance;         // of a white face, linear RGB
  };

  struct Vertex {
    Vec3 voxel;         // where light leaves from, voxel space
    Vec3 before;        // direction of the path up to here, grid frame
    Vec3 normal{0};     // of a surface, towards the viewer
    Material material;  // specular is 0 where there is no highlight
    bool surface = false;
    bool first = false;
  };

  Ray make_ray(const Vec3& origin, const Vec3& direction) const {
    Ray ray{origin, direction, scene_.voxel_direction(direction), Vec3(0)};
    for (int k = 0; k < 3; ++k) {
      ray.inverse[k] = 1.0f / (std::abs(ray.step[k]) > 1e-20f ? ray.step[k] : 1e-20f);
    }
    return ray;
  }
  Ray camera_ray(float x, float y) const;
  Ray lens_ray(float x, float y, float u, float v) const;
  bool clip(const Ray& ray, float& t0, float& t1) const;
  static float leave(const Ray& ray, const IVec3& low);
  bool track(const Ray& ray, float t0, float t1, float optical_depth, Rng& rng,
             Collision& collision) const;
  float transmittance(const Ray& ray, Rng& rng) const;
  Vertex vertex_at(const Ray& ray, const Collision& collision, bool first, PathDraws& draws) const;
  Vec3 scattered(const Vertex& vertex, const Vec3& towards) const;
  Vec3 key_light(const Vertex& vertex, PathDraws& draws) const;
  Vec3 turn(const Vertex& vertex, float u, float v, PathDraws& draws, Vec3& throughput) const;
  const Face* face_at(const Vec3& voxel, const Vec3& direction) const;
  Vec3 shade_face(const Face& face, const Material& material, const Vec3& out,
                  PathDraws& draws) const;
  void add_face(const Vec3& outward, const Vec3& gradient, float offset);

  const CinemaScene& scene_;
  Camera camera_;
  int max_bounces_;
  Lens lens_;
  Vec3 camera_voxel_;
  Vec3 box_min_, box_max_;  // occupied, voxel space
  bool empty_ = false;
  size_t plane_count_ = 0;
  std::array<Face, Cut::kMostPlanes + 6> faces_;  // of the planes, then of the box
  size_t face_count_ = 0;
};

}  // namespace clipgs
