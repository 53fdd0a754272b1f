#pragma once

#include <vector>

#include "section/section.h"
#include "volume/window.h"

namespace clipgs {

/// The windows that a section is usually seen through, as the viewer has them, the first of them at
/// the start: of a CT kCtWindows, else "auto", from the 1st to the 99th percentile of what is not
/// air around the body, and "full". None for photographs.
std::vector<NamedWindow> windows_of(const Section& section);

}  // namespace clipgs
