#pragma once

#include "cinema/picture.h"

namespace clipgs {

/// The picture with less noise: non-local means (Rousselle, Knaus & Zwicker 2012). A pixel becomes
/// a mean of those around it whose surroundings look the same as far as noise lets one tell, which
/// is judged in one half for what is averaged in the other, so that noise does not choose its own
/// company; the albedo first met, hardly noisy, keeps what lies on surfaces. Biased: fine light is
/// blurred where it drowns in noise. The halves of the result are no longer independent: their
/// noise floor is too high a claim.
Picture denoise(const Picture& picture, float exposure);

}  // namespace clipgs
