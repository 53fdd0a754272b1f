#pragma once

#include "core/image.h"
#include "splat/projection.h"

namespace clipgs {

/// The slow, obvious renderer in double precision that the rasteriser is held to: method.md §2 and
/// §3 written down formula by formula, every Gaussian at every pixel. Returns [height, width, 4]
/// premultiplied doubles; `parameters` is laid out as the data() of `shape`, of which nothing else
/// counts.
std::vector<double> reference_render(const std::vector<double>& parameters, const Gaussians& shape,
                                     const Camera& camera, const Cut& cut,
                                     const RasterOptions& options);

}  // namespace clipgs
