#pragma once

#include <cstdint>
#include <vector>

#include "volume/coarse_volume.h"

namespace clipgs {

/// Blood full of contrast, as far as a coarse look shows it.
struct Contrast {
  float ml = 0;
  float hu = 0;  ///< its mean

  bool any() const { return ml > 0; }
  /// Angiographies are made for 250 HU and more in arteries; later phases leave 120 to 200.
  bool arterial() const { return hu >= 220; }
};

/// Heart, aorta and other large vessels: matter of 130 to 600 HU that is even and thick, tall, near
/// the middle, and not lined by what is brighter, as the marrow of bones is.
Contrast find_contrast(const CoarseVolume& coarse);

/// Vessels of the brain: such values within the skull (1 in `in_skull`, one byte a block), where
/// neither bone, nor air, nor much else so bright is near. The mean is that of the brightest tenth:
/// thin vessels fill few blocks.
Contrast find_brain_contrast(const CoarseVolume& coarse, const std::vector<std::uint8_t>& in_skull);

}  // namespace clipgs
