#pragma once

#include <cstddef>

#include "core/cut.h"
#include "section/section.h"
#include "splat/gaussians.h"

namespace clipgs {

/// Gaussians that show what draw_faces() draws, for programs that draw splats alone: discs in the
/// faces of a cut and in those where the volume ends, in their colours as they are seen from
/// straight before them. Where a face is of one colour discs are larger; there are about `most` at
/// most. `sphere`: of the visible matter.
Gaussians face_splats(const Section& section, const Sphere& sphere, const Cut& cut, size_t most);

}  // namespace clipgs
