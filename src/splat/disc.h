#pragma once

#include "splat/gaussians.h"

namespace clipgs {

/// A flat Gaussian, for what is drawn in closed form.
struct Disc {
  Vec3 position;  ///< as means are
  Vec3 normal;    ///< unit
  Vec3 color;     ///< display sRGB, from all sides
  float wide;     ///< standard deviation across the normal, and
  float thick;    ///< along it
  float opacity;  ///< in (0, 1)
};

/// Sets Gaussian `i` to it.
void place(const Disc& disc, size_t i, Gaussians& gaussians);

}  // namespace clipgs
