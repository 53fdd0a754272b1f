#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace clipgs {

/// Size of a regular file and a text that changes whenever its contents do.
struct FileState {
  std::uintmax_t size = 0;
  std::string version;
};

/// Nothing if `path` is not a regular file, or a link to one, that can be looked at.
std::optional<FileState> file_state(const std::filesystem::path& path);

/// A file open for reading. What it holds stays the same when another is put in its place.
class OpenFile {
 public:
  /// Opens the regular file at `path` if that lies below `folder`, a canonical path, wherever links
  /// lead to. Throws Error, which names the file without its folder: browsers read it.
  OpenFile(const std::filesystem::path& path, const std::filesystem::path& folder);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  const FileState& state() const { return state_; }
  /// Fills `out` from `offset` on; fewer bytes at the end or on an error.
  size_t read(std::uintmax_t offset, std::span<std::uint8_t> out) const;

 private:
  int fd_ = -1;
  FileState state_;
};

}  // namespace clipgs
