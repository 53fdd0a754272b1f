#pragma once

#include <cstddef>
#include <cstdint>

#include "splat/projection.h"

namespace clipgs {

/// Pixels along a tile's side: one AVX-512 vector of floats, two of AVX2, four of SSE or NEON.
constexpr int kTileSize = 16;
constexpr int kTilePixels = kTileSize * kTileSize;

/// One square of the picture, planar: [kTileSize, kTileSize] floats a channel.
struct alignas(64) Tile {
  float r[kTilePixels];  ///< premultiplied colour
  float g[kTilePixels];
  float b[kTilePixels];
  float t[kTilePixels];  ///< transmittance, 1 − alpha
};

/// Thresholds that the kernels need, see RasterOptions.
struct TileLimits {
  float alpha_min, alpha_max, transmittance_min;
};

/// The planes beyond the first that cut splats: `stride` entries a splat.
struct MoreCuts {
  const PlaneCut* cuts = nullptr;
  size_t stride = 0;
};

/// Blends `splats[list[0…count)]`, front to back, behind what is in the tile, whose first pixel is
/// (x0, y0). Returns how many entries of the list were looked at before every pixel was finished.
size_t tile_forward(const Splat* splats, const MoreCuts& more, const std::uint32_t* list,
                    size_t count, float x0, float y0, const TileLimits& limits, Tile& tile);

/// Adjoint of `tile_forward` for splats that one plane cuts at most, which turned the tile `before`
/// into `after`; `gradient` is ∂L/∂(r, g, b, alpha) at each pixel (alpha in `t`). Writes
/// out[slots[k]] for k in [0, count): the forward pass's return value.
void tile_backward(const Splat* splats, const std::uint32_t* list, const std::uint32_t* slots,
                   size_t count, float x0, float y0, const TileLimits& limits, const Tile& before,
                   const Tile& after, const Tile& gradient, SplatGradient* out);

}  // namespace clipgs
