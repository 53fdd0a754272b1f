#pragma once

#include <cstddef>
#include <cstdint>

#include "core/geometry.h"

namespace clipgs {

/// Voxels along each side of what flows together.
constexpr int kFlowBlock = 8;

/// One explicit step of ∂v/∂t = Δv − normal·∂²v/∂n², n the gradient's direction, on a grid.
struct FlowStep {
  std::ptrdiff_t row;    ///< values from one row to the next, and
  std::ptrdiff_t slice;  ///< from one slice to the next
  Vec3 first;            ///< ½ over the spacing
  Vec3 second;           ///< 1 over its square
  float time;            ///< that a voxel flows, for each unit of its freedom
  float normal;          ///< 1: along level sets, 0: along all
};

/// Values of a block of `count` voxels, at most kFlowBlock a side, after a step, in rows of
/// kFlowBlock. `values` and `freedom` begin at its first voxel; every voxel has neighbours. Rows
/// are read, and written, as if they were kFlowBlock long.
void flow_block(const FlowStep& step, const float* values, const std::uint8_t* freedom,
                const IVec3& count, float* next);

}  // namespace clipgs
