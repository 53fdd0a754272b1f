#pragma once

#include <cstddef>

#include "asset/case.h"
#include "core/cut.h"

namespace clipgs {

/// The Gaussians of a case (world space) for programs that draw splats alone and cut nothing, which
/// then show much what draw_case() shows: of its splats what the cut keeps, trimmed, and what its
/// section draws, the faces of the cut and of the volume's ends and the walls that the cut opens,
/// as splats of their own, about `most` of these. Without a section the splats alone, without the
/// colours that they have at a face. Throws Error for a model.
Gaussians filled_splats(const Case& contents, const Cut& cut, size_t most);

}  // namespace clipgs
