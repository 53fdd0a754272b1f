#pragma once

#include <cstdint>
#include <vector>

#include "core/cut.h"
#include "core/image.h"
#include "splat/kept_share.h"
#include "splat/projection.h"
#include "splat/tile_kernel.h"

namespace clipgs {

/// The tile rasteriser: a picture of Gaussians and, for training, its exact adjoint. Keeps its
/// buffers between calls. The result does not depend on the number of threads: every tile sums in
/// depth order, and gradients of one Gaussian are added up in the order of its tiles.
class Rasterizer {
 public:
  /// Draws `gaussians` into [height, width, 4]: premultiplied display sRGB and alpha. They lie
  /// behind `front` (same shape and convention; null: nothing), the faces that planes expose: see
  /// put_behind().
  const Image& forward(const Gaussians& gaussians, const Camera& camera, const Cut& cut,
                       const RasterOptions& options, const Image* front = nullptr);

  /// Given ∂L/∂image of the last `forward` (same shape; one plane at most), writes ∂L/∂parameter
  /// for every Gaussian that reached a pixel. Planes of others, whose gradient is 0, are left as
  /// they are: ask `reached`.
  void backward(const Gaussians& gaussians, const Image& image_gradient, Gaussians& gradients);

  /// ∂L/∂gain, of the plane of the last `backward` (0 where there is none).
  const Vec3& gain_gradient() const { return gain_gradient_; }

  /// Ascending indices of the Gaussians whose gradient the last `backward` wrote. The rest were cut
  /// away, out of the frame or hidden behind others.
  const std::vector<std::uint32_t>& reached() const { return reached_; }

 private:
  size_t more_planes() const { return planes_.empty() ? 0 : planes_.size() - 1; }
  void project_all(const Gaussians& gaussians);
  void sort_by_depth();
  void bin_into_tiles();
  float share_of(size_t pixel) const {
    return share_.at(static_cast<int>(pixel % static_cast<size_t>(camera_.width)),
                     static_cast<int>(pixel / static_cast<size_t>(camera_.width)));
  }
  void start(int tx, int ty, Tile& tile) const;
  SplatGradient summed_gradient(std::uint32_t splat) const;

  Camera camera_;
  std::vector<LitPlane> planes_;
  RasterOptions options_;
  Image image_;
  Image front_;  // empty: nothing
  Image alone_;  // the splats without it, and before share_
  KeptShare share_;
  int tiles_x_ = 0;
  int tiles_y_ = 0;

  std::vector<Splat> projected_;       // of each Gaussian; meaningful where visible_
  std::vector<PlaneCut> more_cuts_;    // planes beyond the first, of each Gaussian
  std::vector<std::uint8_t> visible_;  // of each Gaussian
  std::vector<std::uint32_t> order_;   // drawn Gaussians, near to far
  std::vector<Splat> splats_;          // the same, gathered
  std::vector<PlaneCut> cuts_;         // the same of more_cuts_
  std::vector<std::uint32_t> rank_;    // of each drawn Gaussian: its place in order_
  std::vector<std::uint32_t> sort_scratch_;

  // One instance per (splat, tile) pair. Slots run splat by splat; a tile's list names splats in
  // depth order, and beside each its slot.
  std::vector<std::uint32_t> slot_begin_;  // of each splat, one more at the end
  std::vector<std::uint32_t> tile_begin_;  // of each tile's list, one more at the end
  std::vector<std::uint32_t> list_;
  std::vector<std::uint32_t> slots_;
  std::vector<std::uint32_t> used_;  // of each tile: entries looked at by the forward pass
  std::vector<std::uint32_t> chunk_counts_;
  std::vector<SplatGradient> instance_gradients_;
  std::vector<std::uint8_t> has_gradient_;  // of each Gaussian
  std::vector<std::uint32_t> reached_;
  Vec3 gain_gradient_{0};
};

}  // namespace clipgs
