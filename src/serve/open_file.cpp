#include "serve/open_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

std::optional<FileState> state_of(const struct stat& status) {
  if (!S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  FileState state;
  state.size = static_cast<std::uintmax_t>(status.st_size);
  // Who writes a file can set its time of modification back, but not that of its change.
  state.version = fmt::format("{:x}-{:x}-{:x}{:08x}-{:x}{:08x}", status.st_size, status.st_ino,
                              status.st_mtim.tv_sec, status.st_mtim.tv_nsec, status.st_ctim.tv_sec,
                              status.st_ctim.tv_nsec);
  return state;
}

/// Where an open file really lies. Asked of the kernel after opening, as a path that was checked
/// before may lead elsewhere by then.
fs::path real_path(int fd) {
  std::error_code error;
  return fs::read_symlink(fmt::format("/proc/self/fd/{}", fd), error);
}

bool lies_below(const fs::path& path, const fs::path& folder) {
  return std::ranges::mismatch(folder, path).in1 == folder.end();
}

}  // namespace

std::optional<FileState> file_state(const fs::path& path) {
  struct stat status{};
  if (::stat(path.c_str(), &status) != 0) {
    return std::nullopt;
  }
  return state_of(status);
}

OpenFile::OpenFile(const fs::path& path, const fs::path& folder) {
  const std::string name = path.filename().string();
  // Not to wait for the other end of a pipe.
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd_ < 0) {
    throw Error("{}: cannot be read ({}); check its permissions", name, std::strerror(errno));
  }
  struct stat status{};
  const bool looked_at = ::fstat(fd_, &status) == 0;
  const std::optional<FileState> state = looked_at ? state_of(status) : std::nullopt;
  const bool below = lies_below(real_path(fd_), folder);
  if (!state || !below) {
    ::close(fd_);
    throw below ? Error("{}: is not a regular file; put the case itself there", name)
                : Error("{}: is a link that leaves the folder; put the case itself there", name);
  }
  state_ = *state;
}

OpenFile::~OpenFile() { ::close(fd_); }

size_t OpenFile::read(std::uintmax_t offset, std::span<std::uint8_t> out) const {
  size_t done = 0;
  while (done < out.size()) {
    const ssize_t n =
        ::pread(fd_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) {
      continue;
    }
    if (n <= 0) {
      break;
    }
    done += static_cast<size_t>(n);
  }
  return done;
}

}  // namespace clipgs
