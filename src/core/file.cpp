#include "core/file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <unistd.h>

#include "core/error.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

/// A file descriptor that closes itself and, until `keep` is called, removes the file as well.
class TemporaryFile {
 public:
  explicit TemporaryFile(fs::path path) : path_(std::move(path)) {
    fd_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  }
  ~TemporaryFile() {
    close();
    if (!kept_) {
      ::unlink(path_.c_str());
    }
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

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
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return fd < 0 || ::close(fd) == 0;
  }
  void keep() { kept_ = true; }

 private:
  fs::path path_;
  int fd_ = -1;
  bool kept_ = false;
};

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
  fs::path temporary = path;
  temporary += ".part" + std::to_string(::getpid());
  TemporaryFile file(temporary);
  if (!file.is_open() || !file.write(data, size) || !file.close()) {
    fail_writing(path, errno);
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    fail_writing(path, errno);
  }
  file.keep();
  sync_folder(folder_of(path));
}

void write_text(const fs::path& path, std::string_view text) {
  write_file(path, text.data(), text.size());
}

void require_writable(const fs::path& path) {
  if (fs::is_directory(path)) {
    throw Error("{}: is a folder, a file name was expected", path.string());
  }
  fs::path probe = path;
  probe += ".part" + std::to_string(::getpid());
  const TemporaryFile file(probe);
  if (!file.is_open()) {
    fail_writing(path, errno);
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

void create_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    throw Error("{}: the folder cannot be created ({}); choose one you can write to", path.string(),
                error.message());
  }
}

}  // namespace clipgs
