#pragma once

#include "core/image.h"

namespace clipgs {

/// Training as a case is drawn: with the outline of its section (section/outline.h), which in the
/// pictures is their own alpha. Splats then learn colours at rims, and are round there for nothing.
/// All images [h, w, 4]: premultiplied display sRGB and alpha; `faces` may be null.

/// `drawn` as draw_outline() gives it: where it covers a pixel in part, as much as `truth` does.
void outline_by_truth(const Image& drawn, const Image* faces, const Image& truth, Image& outlined);

/// ∂L/∂drawn from ∂L/∂outlined, in place. How much the section has to say (Outline::share()) counts
/// as constant; `alpha_weight`: of an L1 loss of the alpha that is drawn, so that splats alone,
/// too, end about where matter does.
void outline_by_truth_backward(const Image& drawn, const Image* faces, const Image& truth,
                               float alpha_weight, Image& gradient);

}  // namespace clipgs
