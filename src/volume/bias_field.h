#pragma once

#include <string>

#include "volume/volume.h"

namespace clipgs {

/// What a volume's values were divided by.
struct BiasField {
  float least = 1;
  float most = 1;
};

/// Evens out the smooth field that the coils of an MR scanner multiply its signal with. The field
/// is sought as by N4 (Tustison et al., IEEE TMI 29, 2010): in the logarithm of what is above
/// least_signal(), on a grid of at most 48 voxels along each axis, the histogram is sharpened
/// (Sled, Zijdenbos and Evans, IEEE TMI 17, 1998), and a B-spline of 1, then 2, then 4 pieces along
/// each axis fitted to what that changes, until it changes no more. Its mean over the foreground is
/// 1 (geometric). Throws Error for values that have no logarithm: photographs, and what has its
/// foreground below zero.
BiasField correct_bias(Volume& volume, const std::string& where);

}  // namespace clipgs
