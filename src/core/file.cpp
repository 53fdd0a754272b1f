#include "core/file.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

/// What ends the name of a file that is being written; no other program's files end so.
constexpr std::string_view kTemporaryMark = ".clipgs-";
constexpr std::string_view kTemporaryEnd = ".part";

/// The file that is written before it is renamed to `path`. It is locked as long as it is open, so
/// that sweep_leftovers() knows it from those of killed processes. Closes itself and, until `keep`
/// is called, removes the file as well.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& path) {
    // A name is taken by what a killed process of this number left, or one of another machine.
    constexpr int kMostNames = 1000;
    for (int i = 0; i < kMostNames && fd_ < 0; ++i) {
      path_ = path;
      path_ += fmt::format("{}{}{}{}", kTemporaryMark, ::getpid(),
                           i > 0 ? fmt::format("-{}", i) : "", kTemporaryEnd);
      fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
      if (fd_ < 0 && errno != EEXIST) {
        return;
      }
      if (fd_ >= 0 && swept_before_locked()) {
        close();
      }
    }
  }
  ~TemporaryFile() {
    if (fd_ >= 0 && !kept_) {
      ::unlink(path_.c_str());
    }
    close();
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const fs::path& path() const { return path_; }
  bool is_open() const { return fd_ >= 0; }
  bool write(const void* data, size_t size) const {
    const char* p = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t n = ::write(fd_, p, size);
      if (n < 0 && errno == EINTR) {
        continue;
      }
      if (n <= 0) {
        return false;
      }
      p += n;
      size -= static_cast<size_t>(n);
    }
    return ::fsync(fd_) == 0;
  }
  void keep() { kept_ = true; }

 private:
  /// Locks. A file system without locks has no sweeping either.
  bool swept_before_locked() const {
    struct stat status{};
    return ::flock(fd_, LOCK_EX) == 0 && ::fstat(fd_, &status) == 0 && status.st_nlink == 0;
  }
  void close() {
    if (fd_ >= 0) {
      ::close(fd_);
    }
    fd_ = -1;
  }

  fs::path path_;
  int fd_ = -1;
  bool kept_ = false;
};

bool is_temporary(const std::string& name) {
  const size_t mark = name.rfind(kTemporaryMark);
  if (mark == std::string::npos || !name.ends_with(kTemporaryEnd)) {
    return false;
  }
  const size_t begin = mark + kTemporaryMark.size();
  const size_t end = name.size() - kTemporaryEnd.size();
  return begin < end && name.find_first_not_of("0123456789-", begin) >= end;
}

/// Removes a temporary unless a process holds it.
void remove_if_left(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  if (fd < 0) {
    return;
  }
  struct stat held{};
  struct stat named{};
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0 && ::fstat(fd, &held) == 0 &&
      ::lstat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino) {
    ::unlink(path.c_str());
  }
  ::close(fd);
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Makes the rename itself survive a power cut.
void sync_folder(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd >= 0) {
    ::fsync(fd);
    ::close(fd);
  }
}

[[noreturn]] void fail_writing(const fs::path& path, int error) {
  throw Error("{}: cannot be written ({}); choose a folder you can write to, with free space",
              path.string(), std::strerror(error));
}

const char* kind_of(fs::file_type type) {
  switch (type) {
    case fs::file_type::directory:
      return "a folder";
    case fs::file_type::fifo:
      return "a pipe";
    case fs::file_type::socket:
      return "a socket";
    default:
      return "a device";
  }
}

/// Where the file of this name is, or would be: a symbolic link stays, and its target is written.
/// Throws Error if something else than a file is there.
fs::path file_to_replace(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error("{}: is {}, a file name was expected", path.string(), kind_of(status.type()));
  }
  constexpr int kMostLinks = 40;  // as Linux follows
  fs::path target = path;
  for (int i = 0; i < kMostLinks && fs::is_symlink(target, error); ++i) {
    target = folder_of(target) / fs::read_symlink(target, error);
  }
  if (error == std::errc::too_many_symbolic_link_levels || fs::is_symlink(target, error)) {
    throw Error("{}: is a symbolic link that leads nowhere; remove it", path.string());
  }
  return target;
}

}  // namespace

std::vector<std::uint8_t> read_file(const fs::path& path, std::uintmax_t limit) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    throw Error("{}: is a folder, a file was expected", path.string());
  }
  const std::uintmax_t size = fs::file_size(path, error);
  if (error) {
    throw Error("{}: cannot be read ({}); check the path", path.string(), error.message());
  }
  if (size > limit) {
    throw Error(
        "{}: is {} bytes long, more than the {} this format may have; is it the right file?",
        path.string(), size, limit);
  }
  std::vector<std::uint8_t> bytes(size);
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size))) {
    throw Error("{}: cannot be read ({}); check its permissions", path.string(),
                std::strerror(errno));
  }
  return bytes;
}

std::string read_text(const fs::path& path) {
  const std::vector<std::uint8_t> bytes = read_file(path);
  return {bytes.begin(), bytes.end()};
}

void write_file(const fs::path& path, const void* data, size_t size) {
  const fs::path target = file_to_replace(path);
  TemporaryFile file(target);
  // Renamed while it is open, and so locked: a sweep never takes what is about to be renamed.
  if (!file.is_open() || !file.write(data, size) ||
      ::rename(file.path().c_str(), target.c_str()) != 0) {
    fail_writing(path, errno);
  }
  file.keep();
  sync_folder(folder_of(target));
}

void write_text(const fs::path& path, std::string_view text) {
  write_file(path, text.data(), text.size());
}

void require_writable(const fs::path& path) {
  const fs::path target = file_to_replace(path);
  sweep_leftovers(folder_of(target), target.stem().string() + ".");
  const TemporaryFile file(target);
  if (!file.is_open()) {
    fail_writing(path, errno);
  }
}

void sweep_leftovers(const fs::path& folder, const std::string& prefix) {
  std::error_code error;  // of a folder that is not there or cannot be read: nothing to sweep
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with(prefix) && is_temporary(name)) {
      remove_if_left(entry->path());
    }
  }
}

void require_free_space(const fs::path& folder, std::uintmax_t bytes) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (!error && space.available < bytes) {
    throw Error("{}: needs {:.2f} GB, the disk has {:.2f} GB free; choose another folder",
                folder.string(), static_cast<double>(bytes) / 1e9,
                static_cast<double>(space.available) / 1e9);
  }
}

fs::path temporary_folder() {
  const char* folder = std::getenv("TMPDIR");
  return folder == nullptr || *folder == '\0' ? "/tmp" : folder;
}

void create_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    throw Error("{}: the folder cannot be created ({}); choose one you can write to", path.string(),
                error.message());
  }
}

}  // namespace clipgs
