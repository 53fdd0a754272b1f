#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace clipgs {

// What a case says of its decoded images (docs/format.md), so that a decoder that gives others than
// were written is found out, whichever program it belongs to.

/// The CRC-32 (that of ZIP) of bytes, as eight hexadecimal digits.
std::string checksum(std::span<const std::uint8_t> bytes);

/// Throws Error, `name` in it, unless `stated` is the checksum of `bytes`. Null: an older case,
/// which says nothing.
void require_checksum(const nlohmann::json& stated, std::span<const std::uint8_t> bytes,
                      const std::string& name);

/// The checksum of the texels of an image of a case, by its file's name, in its meta.json.
void state_checksum(nlohmann::json& meta, const std::string& file,
                    std::span<const std::uint8_t> rgba);

/// Throws Error, `name` in it, unless it is that. Cases that state none at all are older.
void require_stated_checksum(const nlohmann::json& meta, const std::string& file,
                             std::span<const std::uint8_t> rgba, const std::string& name);

}  // namespace clipgs
