#pragma once

#include <array>
#include <cstdint>

#include "cinema/scene.h"
#include "core/cut.h"

namespace clipgs {

/// A flat face of the visible block: a plane of the cut, or a side of the volume's box.
struct BlockFace {
  Vec3 outward;   ///< grid frame
  Vec3 gradient;  ///< mm per voxel: depth in mm of p = offset − gradient·p
  float offset = 0;
  Vec3 radiance;  ///< of a white face under sky and distant lights, linear RGB
};

/// All that paths of one camera's view of a cut scene depend on.
struct PathView {
  const CinemaScene* scene = nullptr;
  int max_bounces = 1;
  // Camera and lens: the ray of image coordinates (x, y) runs along x'·right + y'·down + forward.
  Vec3 camera_voxel;          // voxel space
  Vec3 right, down, forward;  // grid frame
  Vec2 focal, center;         // px
  float lens_radius = 0;      // mm
  float lens_focus = 0;       // mm
  bool features = false;      // what the camera rays met is wanted, not its light alone
  // What is kept.
  Vec3 box_min, box_max;  // occupied, voxel space
  size_t plane_count = 0;
  size_t face_count = 0;
  float face_depth = 0;  // mm: what lies less deep below a face is lit as the face itself
  float face_reach = 0;  // mm along a ray behind a face: BoundaryLook::kFaceVoxels
  std::array<BlockFace, Cut::kMostPlanes + 6> faces;  // of the planes, then of the box
  // The shadow catcher, in the grid frame.
  bool has_floor = false;
  Vec3 floor_up, floor_middle;  // unit vector; mm
  float floor_radius = 0;       // mm
  float floor_light = 0;        // luminance of a white floor under sky and distant lights
};

/// Paths that are traced together, one array a quantity. `key` and `index` name a path's random
/// numbers (path_draws.h).
struct PathBatch {
  static constexpr size_t kCapacity = 2048;
  static constexpr size_t kPadded = kCapacity + 16;  // kernels store whole vectors

  size_t count = 0;
  // In:
  std::array<float, kPadded> x, y;  ///< image coordinates of the middle of a pixel, px
  std::array<std::uint32_t, kPadded> key, index;
  // Out:
  std::array<std::array<float, kPadded>, 3> radiance;  ///< linear RGB
  std::array<float, kPadded> alpha;                    ///< see PathSample
  // Out, of the matter that the camera ray met, if the view wants features:
  std::array<std::array<float, kPadded>, 3> albedo;
  std::array<std::array<float, kPadded>, 3> normal;  ///< grid frame, outward; 0 within a medium
  std::array<float, kPadded> depth;                  ///< mm from the camera
};

/// Traces the batch: many paths side by side in the lanes of vectors, on the best instruction set
/// that the machine has.
void trace_paths(const PathView& view, PathBatch& batch);

}  // namespace clipgs
