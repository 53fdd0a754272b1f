#pragma once

#include "core/camera.h"
#include "core/image.h"
#include "section/section.h"

namespace clipgs {

/// Side of the blocks that tinted() blurs by, pixels, for pictures that `camera` takes of a
/// section: about as large a part of the body in pictures of any size and from any distance.
int tint_block(const Section& section, const Camera& camera);

/// The surface of a section in the splats' colours: these say what colour it has, the section where
/// it is and what is to be seen on it (method.md §8). The surface V is shown times
/// R = blur(S·V_α) / blur(V·V_α·S_α), where S is what splats show, each channel by itself, in
/// display sRGB; means over blocks of pixels blur.
/// `picture`: premultiplied, of splats behind `faces` (null: none) as put_behind() has them;
/// `surface`: straight (draw_surface()). Returns [height, width, 4]: straight, with the surface's
/// alpha.
Image tinted(const Image& picture, const Image* faces, const Image& surface, int block);

}  // namespace clipgs
