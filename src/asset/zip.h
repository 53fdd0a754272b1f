#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace clipgs {

using Bytes = std::vector<std::uint8_t>;

struct ZipEntry {
  std::string name;
  Bytes bytes;
};

/// Of their contents together.
size_t total_bytes(std::span<const ZipEntry> files);

/// A ZIP of stored entries (method 0) in the given order: sizes and checksums in the local headers,
/// one fixed date, no extra fields, so that the same entries give the same bytes. Throws Error if
/// it would pass what a plain ZIP can hold (4 GiB).
Bytes write_zip(const std::vector<ZipEntry>& entries);

/// The entries of a ZIP in memory, stored or deflated, by name. Throws Error on anything else: a
/// truncated or corrupt archive, a checksum that does not hold, more than 256 entries or 1 GiB.
/// `name` is what errors call it.
std::map<std::string, Bytes> read_zip(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace clipgs
