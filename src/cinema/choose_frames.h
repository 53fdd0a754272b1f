#pragma once

#include <span>
#include <vector>

#include "cinema/dataset.h"
#include "cinema/scene.h"

namespace clipgs {

/// Frames to choose from. Of those of group g, `quotas[g]` are wanted.
struct FramePool {
  std::vector<Frame> frames;
  std::vector<size_t> groups;  ///< of each frame
  std::vector<size_t> quotas;  ///< of each group, at most as many as it has
};

/// Chooses the frames that together leave least unseen of what the pool shows. A surface is a
/// coarse cell of space within `sphere` (mm), looked at from one of six sides, at a cut face, a
/// little below one, or far from any. Frames are taken one after the other, each for the largest
/// fall in Σ p/(1 + n) over surfaces, the expected error of learning: p is the surface's share of
/// the pool's pictures, n how often chosen ones show it. Returns indices into the pool in ascending
/// order. The same at any number of threads.
std::vector<size_t> choose_frames(const CinemaScene& scene, const Sphere& sphere,
                                  const FramePool& pool);

}  // namespace clipgs
