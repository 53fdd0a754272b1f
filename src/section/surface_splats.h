#pragma once

#include <cstddef>

#include "core/cut.h"
#include "section/openings.h"
#include "section/section_light.h"
#include "splat/gaussians.h"

namespace clipgs {

/// About `count` Gaussians that show the lit surfaces of a section as it is uncut, in closed form:
/// nothing is learnt (method.md §8). Each is a nearly opaque disc in the place of what is one
/// surface of a cell of a grid, with its mean place, normal and reflectance, in the light that
/// comes there. Where matter ends because the volume does there are some, too. Surfaces that are
/// dark uncut have none: where a cut lets light in, walls are drawn from the section. `scan`: of
/// the section that `openings` was made of; `openings` draws walls.
Gaussians surface_splats(const Section& section, const SurfaceScan& scan, const Openings& openings,
                         size_t count);

/// The same for walls of cavities that a cut lets light into, for programs that draw splats alone:
/// of what is dark uncut what is lit then and is kept, at most about `most`.
Gaussians wall_splats(const Section& section, const SurfaceScan& scan, const Openings& openings,
                      const Cut& cut, size_t most);

/// Discs of surfaces, those first that light comes to.
struct KeptSurfaces {
  Gaussians discs;
  size_t lit = 0;
};

/// The same of all surfaces that a cut keeps, at most about `most` that are lit and none smaller
/// than a voxel or so. `scan`: of every voxel.
KeptSurfaces kept_surfaces(const Section& section, const SurfaceScan& scan,
                           const Openings& openings, const Cut& cut, size_t most);

}  // namespace clipgs
