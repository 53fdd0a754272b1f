#pragma once

#include "splat/similarity.h"

namespace clipgs {

/// Scene space (x right, y down, z forward) to the axes of glTF and SPZ (x right, y up, z back),
/// and back: half a turn about x.
inline Similarity y_up() { return {glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, -1), 1, {}}; }

}  // namespace clipgs
