#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "asset/zip.h"
#include "splat/gaussians.h"

namespace clipgs {

/// Of SPZ that is written: by zstd, and the one before it, by gzip, which more programs read.
constexpr int kSpzVersion = 4;
constexpr int kOldSpzVersion = 3;

/// Gaussians (scene space, degree 0 to 3) as SPZ (Niantic): about a tenth of a PLY, in bytes of log
/// scales, colours and opacities, 30 bits of rotation and 24 a coordinate. Axes are SPZ's own, x
/// right, y up, z back. Throws Error, also where a coordinate is more than 2,000 m off.
Bytes encode_spz(const Gaussians& scene, int version = kSpzVersion);

/// The Gaussians (scene space) of SPZ of versions 2 to 4. Throws Error, `name` in it, if it is
/// truncated or corrupt, of another version or of a degree above 3; nothing larger than what it
/// says of itself warrants is allocated.
Gaussians decode_spz(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace clipgs
