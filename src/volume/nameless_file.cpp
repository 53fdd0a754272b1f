#include "volume/nameless_file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& folder, const char* what) {
  throw Error("{}: a temporary file cannot be {} ({}); set TMPDIR to a folder with free space",
              folder.string(), what, std::strerror(errno));
}

}  // namespace

NamelessFile::NamelessFile() {
  const fs::path folder = temporary_folder();
  file_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file_ < 0) {  // a file system that knows no files without a name
    std::string name = (folder / "clipgs-XXXXXX").string();
    file_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (file_ >= 0) {
      ::unlink(name.c_str());
    }
  }
  if (file_ < 0) {
    fail(folder, "made");
  }
}

NamelessFile::~NamelessFile() { ::close(file_); }

void NamelessFile::append(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written <= 0) {
      fail(temporary_folder(), "written");
    }
    size_ += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
}

std::vector<std::uint8_t> NamelessFile::read(std::uint64_t offset, size_t size) const {
  std::vector<std::uint8_t> bytes(size);
  size_t done = 0;
  while (done < size) {
    const ssize_t got =
        ::pread(file_, &bytes[done], size - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      fail(temporary_folder(), "read");
    }
    done += static_cast<size_t>(got);
  }
  return bytes;
}

}  // namespace clipgs
