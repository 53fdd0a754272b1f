#pragma once

#include <string>

#include "core/image.h"
#include "volume/preset.h"
#include "volume/steepness_histogram.h"

namespace clipgs {

/// Values that suit a preset's histogram: what its points span, and a quarter more on either side.
Vec2 histogram_values(const Preset& preset);

/// Draws a histogram as the logarithm of its counts, with labelled axes (`unit`: of the values,
/// "HU"). Below it are the preset's colours along the values, as dense as a millimetre of its
/// matter, those of its boundary, if it has one, and across the picture where the boundary's look
/// begins and where it is full. RGB. Throws Error.
Image draw_histogram(const SteepnessHistogram& histogram, const Preset& preset,
                     const std::string& unit);

}  // namespace clipgs
