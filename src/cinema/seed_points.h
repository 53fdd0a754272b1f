#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "cinema/dataset.h"
#include "volume/preset.h"
#include "volume/volume.h"

namespace clipgs {

/// About `count` points of the matter that a preset shows: all of the solid interior, denser where
/// the look changes from voxel to voxel. Deterministic for a seed.
std::vector<SeedPoint> sample_seed_points(const Volume& volume, const Preset& preset, size_t count,
                                          std::uint64_t seed);

/// Writes binary little-endian PLY: x y z, nx ny nz (zero), red green blue, spacing.
void save_seed_points(const std::filesystem::path& path, const std::vector<SeedPoint>& points);

}  // namespace clipgs
