#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "splat/gaussians.h"

namespace clipgs {

/// Float properties of a PLY beyond those of 3DGS, by name: one value a splat. Other readers skip
/// them.
using PlyColumns = std::map<std::string, std::vector<float>>;

/// Reads a 3DGS PLY: binary little-endian, one `vertex` element of scalar properties in any order,
/// f_rest_* absent or 9, 24 or 45 of them, f_face_* (face colours) absent or 12 of them; other
/// properties are skipped. Numbers are taken as they stand: the frame and unit are the file's own.
/// Throws Error on anything else, on a truncated file and on numbers that are not finite. Columns
/// that `more` names are filled from the file; those that it lacks stay empty.
Gaussians read_ply(const std::filesystem::path& path, PlyColumns* more = nullptr);
/// The same from memory; `name` is what errors call it.
Gaussians read_ply(std::span<const std::uint8_t> bytes, const std::string& name,
                   PlyColumns* more = nullptr);

/// Bytes that each splat takes in a PLY of write_ply without face colours and further columns.
size_t ply_splat_bytes(int sh_degree);

/// Writes a 3DGS PLY with all of its usual properties (62 floats a splat at degree 3), the numbers
/// as they stand, then face colours and those of `more`. Throws Error.
void write_ply(const std::filesystem::path& path, const Gaussians& gaussians,
               const PlyColumns& more = {});

}  // namespace clipgs
