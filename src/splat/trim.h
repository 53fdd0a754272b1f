#pragma once

#include <span>

#include "splat/gaussians.h"

namespace clipgs {

/// What planes keep of Gaussians, for programs that cut nothing: those whose middle is beyond a
/// plane go, and those that reach beyond it are pressed flat along its normal until they end there
/// (three standard deviations), so that none is left that a cut would have to end.
Gaussians trim(const Gaussians& gaussians, std::span<const Plane> planes);

}  // namespace clipgs
