#pragma once

#include "asset/zip.h"
#include "splat/gaussians.h"

namespace clipgs {

/// Gaussians (scene space) as binary glTF 2.0 with KHR_gaussian_splatting: points, whose attributes
/// are 32-bit floats, nothing rounded; viewers that do not know the extension show coloured points.
/// Axes are glTF's, x right, y up, z towards the viewer, metres. Throws Error if it would pass what
/// the format can hold (4 GiB).
Bytes encode_glb(const Gaussians& scene);

}  // namespace clipgs
