#pragma once

#include <cstdint>
#include <vector>

#include "cinema/dataset.h"
#include "splat/gaussians.h"

namespace clipgs {

/// Gaussians to start from: `count` of the volume's seed points (all of them if there are fewer),
/// as round Gaussians of the local spacing that together look solid, coloured by the transfer
/// function. The same seed picks the same points. Throws Error if there are no points.
Gaussians start_from_points(const std::vector<SeedPoint>& points, size_t count, int sh_degree,
                            std::uint64_t seed);

}  // namespace clipgs
