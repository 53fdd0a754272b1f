#pragma once

#include "cinema/picture.h"

namespace clipgs {

/// The picture with less noise: non-local means with features (Rousselle, Knaus & Zwicker 2012;
/// Rousselle, Manzi & Zwicker 2013). A pixel becomes a mean of those around it whose surroundings
/// look the same as far as noise lets one tell, which is judged in one half for what is averaged in
/// the other, so that noise does not choose its own company. The albedo, normal and depth first
/// met, themselves filtered before, keep edges. Where the halves tell that this does more harm
/// than the noise, the picture stays as it is, pixel by pixel. Biased: fine light is blurred where
/// it drowns in noise; the bias goes as samples grow. The halves of the result are no longer
/// independent: their noise floor is too high a claim. The picture must have been rendered with
/// features (PictureOptions), else Error.
Picture denoise(const Picture& picture, const DisplayTransform& transform);

}  // namespace clipgs
