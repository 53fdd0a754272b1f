#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "asset/zip.h"
#include "core/geometry.h"

namespace clipgs {

/// Of `level` below, the coarsest.
constexpr int kCoarsestAv1 = 63;

/// Slices of constant z, [dims.z, dims.y, dims.x] u8, as the frames of an AV1 video (8 bits, 4:2:0,
/// full range, no colour): each is predicted from those around it, which is where a volume has its
/// redundancy. `level`: AV1's quantizer, 0 (nearly lossless) to kCoarsestAv1, the same for all
/// frames. The stream is temporal units one after the other (AV1 specification, 5.1: low-overhead
/// format), as `ffplay` shows it. The same voxels give the same bytes at any number of threads.
/// Throws Error.
Bytes encode_av1(std::span<const std::uint8_t> voxels, const IVec3& dims, int level);

/// The voxels of such a stream. Throws Error, `name` in it, if it is damaged, or has frames of
/// another size, or another number of them.
std::vector<std::uint8_t> decode_av1(std::span<const std::uint8_t> stream, const IVec3& dims,
                                     const std::string& name);

}  // namespace clipgs
