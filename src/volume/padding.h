#pragma once

#include <cstddef>
#include <optional>

#include "volume/volume.h"

namespace clipgs {

inline constexpr float kAirHu = -1024;  ///< what a CT has where there is nothing, HU

/// What a volume had where its scanner made no picture.
struct Padding {
  float value = 0;
  size_t voxels = 0;
};

/// Sets to air (of a CT, or where the modality is unknown and the other values reach down to −500:
/// kAirHu) or background (0) what a file marks as outside the picture, by the values alone. That is
/// the lowest or the highest value if half of the corners of the slices have it, and no other is
/// near: a lowest one below zero by a tenth of what the others span, a highest one by all of it, or
/// in a CT by anything, for no air is so high. Of the highest, which metal may have as well, only
/// what a flood through it reaches from the slices' borders is set.
std::optional<Padding> remove_padding(Volume& volume);

}  // namespace clipgs
