#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <utility>
#include <vector>

namespace clipgs {

/// Size of a regular file and a text that changes whenever its contents do.
struct FileState {
  std::uintmax_t size = 0;
  std::string version;
};

/// Nothing if `path` is not a regular file that can be looked at.
std::optional<FileState> file_state(const std::filesystem::path& path);

/// A file open for reading. What it holds stays the same when another is put in its place.
class OpenFile {
 public:
  /// Check with `is_open`.
  explicit OpenFile(const std::filesystem::path& path);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  bool is_open() const { return fd_ >= 0; }
  const FileState& state() const { return state_; }
  /// Reads up to `size` bytes from `offset`; fewer at the end or on an error.
  size_t read(std::uintmax_t offset, char* out, size_t size) const;

 private:
  int fd_ = -1;
  FileState state_;
};

/// All but unreserved characters as %XX (RFC 3986).
std::string percent_encode(std::string_view text);

/// MIME type by the ending of a file's name.
const char* content_type(std::string_view path);

/// Whether an If-None-Match header names `etag` (quoted), or says *.
bool etag_matches(std::string_view header, std::string_view etag);

/// First and last byte, −1 where the header leaves one out: "bytes=5-", "bytes=-5".
using ByteRange = std::pair<ssize_t, ssize_t>;

/// The one range that is asked of `size` bytes, with both ends inside; nothing if no byte of it
/// exists, or if there are several (nobody needs them of a case).
std::optional<ByteRange> satisfiable_range(const std::vector<ByteRange>& ranges,
                                           std::uintmax_t size);

/// The host of a Host header, without the port: "localhost:8080", "[::1]:8080".
std::string_view host_name(std::string_view header);

/// Whether `host` can only be reached from this machine.
bool is_loopback(std::string_view host);

}  // namespace clipgs
