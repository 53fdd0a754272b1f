#include "asset/checksum.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include "core/error.h"

namespace clipgs {

using nlohmann::json;

namespace {

constexpr const char* kBlock = "clipgs";
constexpr const char* kChecksums = "checksums";

}  // namespace

std::string checksum(std::span<const std::uint8_t> bytes) {
  return fmt::format("{:08x}", crc32_z(0, bytes.data(), bytes.size()));
}

void require_checksum(const json& stated, std::span<const std::uint8_t> bytes,
                      const std::string& name) {
  if (!stated.is_null() && stated != checksum(bytes)) {
    throw Error(
        "{}: does not decode to what was written (its checksum differs); the file is corrupt, or "
        "libwebp decodes it wrongly",
        name);
  }
}

void state_checksum(json& meta, const std::string& file, std::span<const std::uint8_t> rgba) {
  meta[kBlock][kChecksums][file] = checksum(rgba);
}

void require_stated_checksum(const json& meta, const std::string& file,
                             std::span<const std::uint8_t> rgba, const std::string& name) {
  const auto block = meta.find(kBlock);
  if (block == meta.end() || !block->is_object() || !block->contains(kChecksums)) {
    return;
  }
  const json& checksums = (*block)[kChecksums];
  const bool stated = checksums.is_object() && checksums.contains(file);
  require_checksum(stated ? checksums[file] : json(""), rgba, name + ": " + file);
}

}  // namespace clipgs
