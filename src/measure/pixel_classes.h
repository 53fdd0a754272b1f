#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/camera.h"
#include "core/image.h"

namespace clipgs {

/// What a pixel shows, by where its ray meets matter first in the truth.
enum class PixelClass : std::uint8_t {
  kFace,     ///< matter that begins at the plane or at an end of the volume
  kOpened,   ///< what was hidden behind matter that the plane took away, deeper than the plane
  kOutside,  ///< what is seen without the plane, too
};
inline constexpr std::array kPixelClasses{PixelClass::kFace, PixelClass::kOpened,
                                          PixelClass::kOutside};
const char* pixel_class_name(PixelClass which);  ///< "face", "opened", "outside"

/// First-hit distances along the pixels' rays, [height, width, 1], mm; 0 where nothing is met.
struct FirstHits {
  Image cut;
  Image uncut;  ///< … without the plane; of no use where there is none
};

/// The class of every pixel, in rows from the top. A first hit within `tolerance` (mm) of the
/// plane, where the ray enters through it, or of one of `ends` lies on a face. A ray is opened if
/// the plane took away matter that it would have met before; the rest, and rays that meet nothing
/// with or without the plane, are outside. Throws Error for hits that are no pictures of the
/// camera's size.
std::vector<PixelClass> classify_pixels(const FirstHits& hits, const Camera& camera,
                                        const std::optional<Plane>& plane,
                                        std::span<const Plane> ends, float tolerance);

}  // namespace clipgs
