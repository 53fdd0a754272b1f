#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "asset/section_slices.h"
#include "asset/webp.h"
#include "asset/zip.h"
#include "section/section.h"

namespace clipgs {

/// Appends the section's voxels to `files` and returns its JSON (docs/format.md), see
/// encode_slices(). The error with which values can be read back, as the JSON states it, includes
/// what coding loses.
/// Throws Error.
nlohmann::json encode_section(const Section& section, float quality, std::vector<ZipEntry>& files,
                              Saving saving = Saving::kBytes);

/// The section of such JSON. Throws Error, `name` in it, on whatever is missing, out of range,
/// undecodable or decoded to something else than its checksum says; nothing larger than its
/// dims warrant is allocated.
Section decode_section(const nlohmann::json& object, const std::map<std::string, Bytes>& files,
                       const std::string& name);

/// What a case says of its section.
struct SectionInfo {
  IVec3 dims{0};
  size_t bytes = 0;  ///< of its voxels' file
  ToneCurve tone = ToneCurve::kSrgb;
};

/// The same without decoding. `sizes`: of the case's files, in bytes, by name. Throws Error.
SectionInfo section_info(const nlohmann::json& object, const std::map<std::string, size_t>& sizes,
                         const std::string& name);

/// Where the section of a scene lies: NAME.section.zip beside NAME.ply.
std::filesystem::path section_path(std::filesystem::path scene);

/// A section by itself, as work in progress keeps it: quick to write. Written whole or not at all.
/// Throws Error.
void write_section(const std::filesystem::path& path, const Section& section);
Section read_section(const std::filesystem::path& path);

}  // namespace clipgs
