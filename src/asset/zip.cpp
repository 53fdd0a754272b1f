#include "asset/zip.h"

#include <algorithm>
#include <archive.h>
#include <archive_entry.h>
#include <array>
#include <cerrno>
#include <cstdio>
#include <limits>
#include <memory>
#include <zlib.h>

#include "core/error.h"

namespace clipgs {

namespace {

constexpr std::uint32_t kLocalHeader = 0x04034b50;
constexpr std::uint32_t kCentralHeader = 0x02014b50;
constexpr std::uint32_t kEndOfCentralDirectory = 0x06054b50;
constexpr std::uint16_t kVersionNeeded = 10;        // 1.0: stored entries
constexpr std::uint16_t kUtf8Names = 1U << 11;      // general purpose flag
constexpr std::uint16_t kDosDate = (1U << 5) | 1U;  // 1980-01-01, the format's zero
constexpr size_t kMaxEntries = 256;
constexpr size_t kMaxTotal = size_t{1} << 30;
/// Of a ZIP that is read in parts: of the entries that are wanted, and of the whole file, where
/// directories of millions of entries would be read for long and into much memory.
constexpr size_t kMaxWanted = size_t{4} << 20;
constexpr size_t kMaxRead = size_t{12} << 20;

void put16(Bytes& out, std::uint16_t value) {
  out.push_back(static_cast<std::uint8_t>(value));
  out.push_back(static_cast<std::uint8_t>(value >> 8));
}

void put32(Bytes& out, std::uint32_t value) {
  put16(out, static_cast<std::uint16_t>(value));
  put16(out, static_cast<std::uint16_t>(value >> 16));
}

/// The fields that a local header and its copy in the central directory share.
void put_common(Bytes& out, const ZipEntry& entry, std::uint32_t checksum) {
  put16(out, kVersionNeeded);
  put16(out, kUtf8Names);
  put16(out, 0);  // method: stored
  put16(out, 0);  // time
  put16(out, kDosDate);
  put32(out, checksum);
  put32(out, static_cast<std::uint32_t>(entry.bytes.size()));  // compressed
  put32(out, static_cast<std::uint32_t>(entry.bytes.size()));
  put16(out, static_cast<std::uint16_t>(entry.name.size()));
  put16(out, 0);  // extra field
}

struct ArchiveCloser {
  void operator()(archive* a) const { archive_read_free(a); }
};
using ArchiveReader = std::unique_ptr<archive, ArchiveCloser>;

[[noreturn]] void fail_reading(const std::string& name, archive* a) {
  const char* reason = archive_error_string(a);
  throw Error("{}: is not a readable case, it is truncated or corrupt ({})", name,
              reason != nullptr ? reason : "not a ZIP");
}

/// The current entry's content. Sizes stated in the archive are not believed: memory grows with
/// what really comes out, up to `room`, of `limit` for all entries.
Bytes read_entry(archive* a, const std::string& name, size_t room, size_t limit) {
  Bytes content;
  const void* block = nullptr;
  size_t size = 0;
  la_int64_t offset = 0;
  for (;;) {
    const int status = archive_read_data_block(a, &block, &size, &offset);
    if (status == ARCHIVE_EOF) {
      return content;
    }
    if (status != ARCHIVE_OK || static_cast<size_t>(offset) != content.size()) {
      fail_reading(name, a);
    }
    if (size > room - content.size()) {
      throw Error("{}: holds more than {} MiB; no case is that large", name, limit >> 20);
    }
    const auto* bytes = static_cast<const std::uint8_t*>(block);
    content.insert(content.end(), bytes, bytes + size);
  }
}

/// Calls `visit` with the name of each entry, none of them twice, while its content can be read.
template <typename Visit>
void for_each_entry(archive* a, const std::string& name, Visit visit) {
  std::set<std::string> names;
  archive_entry* entry = nullptr;
  for (;;) {
    const int status = archive_read_next_header(a, &entry);
    if (status == ARCHIVE_EOF) {
      return;
    }
    if (status != ARCHIVE_OK) {
      fail_reading(name, a);
    }
    const char* path = archive_entry_pathname(entry);
    if (path == nullptr || names.size() >= kMaxEntries) {
      throw Error("{}: holds more than {} files, or one without a name; is it a case?", name,
                  kMaxEntries);
    }
    if (!names.emplace(path).second) {
      throw Error("{}: holds \"{}\" twice; the file is corrupt", name, path);
    }
    visit(std::string(path), entry);
  }
}

/// The seekable reader alone: it goes by the central directory, as browsers do.
ArchiveReader make_reader(const std::string& name) {
  ArchiveReader reader(archive_read_new());
  if (!reader || archive_read_support_format_zip_seekable(reader.get()) != ARCHIVE_OK) {
    fail_reading(name, reader.get());
  }
  return reader;
}

/// What the library's callbacks are given: where it reads, and how much it still may.
struct PartReader {
  const ByteSource& source;
  std::uint64_t position = 0;
  size_t room = kMaxRead;
  std::array<std::uint8_t, size_t{16} << 10> buffer{};
};

la_ssize_t read_part(archive* a, void* data, const void** block) {
  auto& reader = *static_cast<PartReader*>(data);
  *block = reader.buffer.data();
  if (reader.position >= reader.source.size) {
    return 0;
  }
  const size_t size =
      std::min<std::uint64_t>(reader.buffer.size(), reader.source.size - reader.position);
  if (size > reader.room) {
    archive_set_error(a, EFBIG, "its directory is too large");
    return ARCHIVE_FATAL;
  }
  const size_t n = reader.source.read(reader.position, std::span(reader.buffer).first(size));
  if (n != size) {
    archive_set_error(a, EIO, "it cannot be read");
    return ARCHIVE_FATAL;
  }
  reader.position += n;
  reader.room -= n;
  return static_cast<la_ssize_t>(n);
}

la_int64_t seek_part(archive* /*a*/, void* data, la_int64_t offset, int whence) {
  auto& reader = *static_cast<PartReader*>(data);
  const auto size = static_cast<la_int64_t>(reader.source.size);
  const auto position = static_cast<la_int64_t>(reader.position);
  const la_int64_t from = whence == SEEK_END ? size : whence == SEEK_CUR ? position : 0;
  if (offset < -from || offset > size - from) {
    return ARCHIVE_FATAL;
  }
  reader.position = static_cast<std::uint64_t>(from + offset);
  return from + offset;
}

la_int64_t skip_part(archive* /*a*/, void* data, la_int64_t request) {
  auto& reader = *static_cast<PartReader*>(data);
  const auto skipped =
      std::min<std::uint64_t>(static_cast<std::uint64_t>(std::max<la_int64_t>(0, request)),
                              reader.source.size - reader.position);
  reader.position += skipped;
  return static_cast<la_int64_t>(skipped);
}

/// for_each_entry of a ZIP that is read in parts.
template <typename Visit>
void for_each_entry(const ByteSource& source, const std::string& name, Visit visit) {
  PartReader parts{source};
  const ArchiveReader reader = make_reader(name);
  archive* a = reader.get();
  if (archive_read_set_read_callback(a, read_part) != ARCHIVE_OK ||
      archive_read_set_seek_callback(a, seek_part) != ARCHIVE_OK ||
      archive_read_set_skip_callback(a, skip_part) != ARCHIVE_OK ||
      archive_read_set_callback_data(a, &parts) != ARCHIVE_OK ||
      archive_read_open1(a) != ARCHIVE_OK) {
    fail_reading(name, a);
  }
  for_each_entry(a, name,
                 [&](const std::string& path, archive_entry* entry) { visit(path, a, entry); });
}

}  // namespace

Bytes write_zip(const std::vector<ZipEntry>& entries) {
  Bytes out;
  Bytes directory;
  std::uint64_t total = 0;
  for (const ZipEntry& entry : entries) {
    total += entry.bytes.size() + 2 * entry.name.size() + 128;
    if (total > std::numeric_limits<std::uint32_t>::max() || entries.size() > kMaxEntries) {
      throw Error("the case would be larger than 4 GiB; use fewer Gaussians");
    }
    const auto offset = static_cast<std::uint32_t>(out.size());
    const auto checksum = static_cast<std::uint32_t>(
        ::crc32(0, entry.bytes.data(), static_cast<uInt>(entry.bytes.size())));
    put32(out, kLocalHeader);
    put_common(out, entry, checksum);
    out.insert(out.end(), entry.name.begin(), entry.name.end());
    out.insert(out.end(), entry.bytes.begin(), entry.bytes.end());

    put32(directory, kCentralHeader);
    put16(directory, kVersionNeeded);  // made by
    put_common(directory, entry, checksum);
    put16(directory, 0);  // comment
    put16(directory, 0);  // disk
    put16(directory, 0);  // internal attributes
    put32(directory, 0);  // external attributes
    put32(directory, offset);
    directory.insert(directory.end(), entry.name.begin(), entry.name.end());
  }
  const auto begin = static_cast<std::uint32_t>(out.size());
  out.insert(out.end(), directory.begin(), directory.end());
  put32(out, kEndOfCentralDirectory);
  put16(out, 0);  // this disk
  put16(out, 0);  // the directory's disk
  put16(out, static_cast<std::uint16_t>(entries.size()));
  put16(out, static_cast<std::uint16_t>(entries.size()));
  put32(out, static_cast<std::uint32_t>(directory.size()));
  put32(out, begin);
  put16(out, 0);  // comment
  return out;
}

std::map<std::string, Bytes> read_zip(std::span<const std::uint8_t> bytes,
                                      const std::string& name) {
  const ArchiveReader reader = make_reader(name);
  archive* a = reader.get();
  if (archive_read_open_memory(a, bytes.data(), bytes.size()) != ARCHIVE_OK) {
    fail_reading(name, a);
  }
  std::map<std::string, Bytes> entries;
  size_t room = kMaxTotal;
  for_each_entry(a, name, [&](const std::string& path, archive_entry* /*entry*/) {
    Bytes content = read_entry(a, name, room, kMaxTotal);
    room -= content.size();
    entries.emplace(path, std::move(content));
  });
  return entries;
}

std::map<std::string, size_t> list_zip(const ByteSource& source, const std::string& name) {
  std::map<std::string, size_t> sizes;
  for_each_entry(source, name, [&](const std::string& path, archive* /*a*/, archive_entry* entry) {
    sizes.emplace(path, static_cast<size_t>(std::max<la_int64_t>(0, archive_entry_size(entry))));
  });
  return sizes;
}

std::map<std::string, Bytes> read_zip(const ByteSource& source, const std::string& name,
                                      const std::set<std::string>& wanted) {
  std::map<std::string, Bytes> entries;
  size_t room = kMaxWanted;
  for_each_entry(source, name, [&](const std::string& path, archive* a, archive_entry* /*entry*/) {
    if (wanted.contains(path)) {
      Bytes content = read_entry(a, name, room, kMaxWanted);
      room -= content.size();
      entries.emplace(path, std::move(content));
    }
  });
  return entries;
}

size_t total_bytes(std::span<const ZipEntry> files) {
  size_t sum = 0;
  for (const ZipEntry& file : files) {
    sum += file.bytes.size();
  }
  return sum;
}

}  // namespace clipgs
