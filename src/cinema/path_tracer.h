#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cinema/path_kernel.h"
#include "cinema/scene.h"
#include "core/camera.h"
#include "core/cut.h"

namespace clipgs {

/// One path to trace, through a random point of the pixel about image coordinates x, y (px), and
/// the name of its random numbers (path_draws.h).
struct PathStart {
  float x = 0;
  float y = 0;
  std::uint32_t key = 0;
  std::uint32_t index = 0;
};

/// Light along one camera path. Where it misses, all is zero: the picture's background is empty.
struct PathSample {
  Vec3 radiance{0};
  /// Its mean is the picture's alpha: 1 if the camera ray met matter; on a floor the share of light
  /// that is found missing there.
  float alpha = 0;
  // Of the matter that the camera ray met, if the tracer returns features:
  Vec3 albedo{0};
  Vec3 normal{0};   ///< unit, outward, in the grid's frame; 0: scattered within a medium
  float depth = 0;  ///< mm from the camera
};

/// A thin lens. What is not at its focus is blurred.
struct Lens {
  float radius = 0;  ///< mm; 0: a pinhole, all is sharp
  float focus = 0;   ///< mm along the view's axis to the plane that is sharp
};

/// A shadow catcher: a disc that shows nothing but the shadow that falls on it, black, from above.
struct Floor {
  Vec3 up;           ///< unit RAS vector
  Vec3 middle;       ///< RAS, mm
  float radius = 0;  ///< mm; shadows fade out towards it
};

/// What a tracer does besides.
struct PathOptions {
  Lens lens = {};
  std::optional<Floor> floor = std::nullopt;
  bool features = false;  ///< samples tell what the camera ray met
};

/// Unbiased volumetric path tracing (up to `max_bounces`) of one camera's view of what a cut keeps
/// of a scene: delta tracking against macrocell majorants, hybrid surface/phase scattering
/// after Exposure Render (Kroes 2012), next-event estimation of the key lights, the sky by
/// following the paths.
class PathTracer {
 public:
  /// The scene must outlive the tracer.
  PathTracer(const CinemaScene& scene, const Camera& camera, const Cut& cut, int max_bounces,
             const PathOptions& options = {});

  /// Traces any number of paths; each sample depends on its start alone. Safe on many threads at
  /// once.
  std::vector<PathSample> trace(std::span<const PathStart> starts) const;

  /// Median distance along the ray, mm, at which it first meets matter: where half of what the ray
  /// meets in all lies behind it. 0 where it meets nothing (alpha < 1/255).
  float first_hit(float x, float y) const;

 private:
  struct Ray {
    Vec3 origin;   // voxel space
    Vec3 step;     // voxels per mm
    Vec3 inverse;  // mm per voxel, finite
  };

  Ray camera_ray(float x, float y) const;
  bool clip(const Ray& ray, float& t0, float& t1) const;
  void add_face(const Vec3& outward, const Vec3& gradient, float offset);

  const CinemaScene& scene_;
  Camera camera_;
  PathView view_;
  bool empty_ = false;
};

}  // namespace clipgs
