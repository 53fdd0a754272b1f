#pragma once

#include "volume/volume.h"

namespace clipgs {

/// What is above this is neither air nor background: kLeastMatter of CT, least_signal() of anything
/// else.
float least_matter(const Volume& volume);

}  // namespace clipgs
