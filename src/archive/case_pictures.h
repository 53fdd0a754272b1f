#pragma once

#include <vector>

#include "asset/case.h"
#include "core/image.h"

namespace clipgs {

/// What a case looks like from all around, once about the patient's long axis from the front on:
/// RGB on black, `side` px high and wide, each with the words that it is not for diagnosis.
std::vector<Image> turntable(Case contents, int pictures, int side);

}  // namespace clipgs
