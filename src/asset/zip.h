#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace clipgs {

using Bytes = std::vector<std::uint8_t>;

/// A file of a ZIP.
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

/// Bytes that lie elsewhere and are read in parts.
struct ByteSource {
  std::uint64_t size = 0;
  /// Fills `out` from `offset` on; returns how many bytes there are, fewer at the end or where
  /// they cannot be read.
  std::function<size_t(std::uint64_t offset, std::span<std::uint8_t> out)> read;
};

/// Sizes of the entries of a ZIP in bytes, as its directory states them, by name. Nothing but
/// headers is read, and no more than 12 MiB of them. Throws Error as read_zip does.
std::map<std::string, size_t> list_zip(const ByteSource& source, const std::string& name);

/// Those entries of a ZIP that are `wanted` and there, at most 4 MiB of them; of all others the
/// headers alone are read, so that what is broken in them is not noticed. Throws Error as read_zip
/// does.
std::map<std::string, Bytes> read_zip(const ByteSource& source, const std::string& name,
                                      const std::set<std::string>& wanted);

}  // namespace clipgs
