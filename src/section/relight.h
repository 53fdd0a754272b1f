#pragma once

#include "section/openings.h"
#include "splat/gaussians.h"

namespace clipgs {

/// The Gaussians as they look under another light than that which they were trained under: of
/// another rig, and of a cut, whose shadows are others. Each takes the change of light of the
/// surface it lies at, on either side of its shortest axis, as its mean colour does. `tone`: of the
/// pictures that they were trained on.
Gaussians relit(const Gaussians& gaussians, const OpenedLight& light, ToneCurve tone);

}  // namespace clipgs
