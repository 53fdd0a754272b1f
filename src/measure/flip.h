#pragma once

#include "core/image.h"

namespace clipgs {

/// Of a Quest 3, at the middle of its lenses (Meta's figure).
constexpr float kHeadsetPixelsPerDegree = 25;
/// Of a desk display, as the paper has it: 0.7 m away, 0.7 m and 3840 pixels wide.
constexpr float kDeskPixelsPerDegree = 67.02064f;

/// ꟻLIP: the difference that someone sees who flips between two pictures, of every pixel, from 0
/// (none) to 1: [height, width, 1] (Andersson et al. 2020, A Difference Evaluator for Alternating
/// Images). Both in display sRGB [0, 1] over black. `pixels_per_degree` (greater than 0) of the
/// display they are looked at on: what is too fine to be seen at that does not count. Throws Error
/// when the sizes differ.
Image flip_map(const Image& truth, const Image& picture, float pixels_per_degree);

}  // namespace clipgs
