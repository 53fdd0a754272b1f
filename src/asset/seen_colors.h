#pragma once

#include "asset/case.h"
#include "core/cut.h"

namespace clipgs {

/// `discs` (world space, SH of degree 0, their third axes out of the surface) on what draw_case()
/// draws of a case under a cut, in the colours that they have in pictures of it from all around,
/// with SH of degree `sh_degree` (0 or 1). Of those that no picture shows the first `lit` keep
/// their colours; others are left out.
Gaussians in_seen_colors(const Case& contents, const Cut& cut, const Gaussians& discs, size_t lit,
                         int sh_degree);

}  // namespace clipgs
