#include "core/lock.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <fmt/chrono.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr const char* kFolderLock = "clipgs.lock";

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "this machine";
}

/// Who holds the lock, as its text says. Its holder writes that just after locking.
std::string holder(const fs::path& file) {
  constexpr int kTries = 50;
  for (int i = 0; i < kTries; ++i) {
    std::error_code gone;
    if (fs::file_size(file, gone) > 0 && !gone) {
      const std::string text = read_text(file);
      return text.substr(0, text.find('\n'));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return "another process";
}

/// Whether the open file still has its name: a former holder removes it when it is done.
bool is_named(int fd, const fs::path& file) {
  struct stat open{};
  struct stat named{};
  return ::fstat(fd, &open) == 0 && ::stat(file.c_str(), &named) == 0 &&
         open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

}  // namespace

FileLock::FileLock(fs::path file, const fs::path& place, const std::string& remedy)
    : file_(std::move(file)) {
  while (!take(place, remedy)) {
  }
}

/// False if a former holder removed the file just now.
bool FileLock::take(const fs::path& place, const std::string& remedy) {
  fd_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0) {
    throw Error("{}: cannot be written ({}); choose a folder you can write to", file_.string(),
                std::strerror(errno));
  }
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    if (error == EWOULDBLOCK) {
      ::close(fd_);
      throw Error("{}: {} is at work here; wait until it ends, or {}", place.string(),
                  holder(file_), remedy);
    }
    warn(fmt::format("{}: cannot be locked ({}); let no second clipgs work here", place.string(),
                     std::strerror(error)));
  }
  if (!is_named(fd_, file_)) {
    ::close(fd_);
    return false;
  }
  const std::string text = fmt::format("process {} on {} (since {:%Y-%m-%d %H:%M:%S} UTC)\n",
                                       ::getpid(), host_name(), fmt::gmtime(std::time(nullptr)));
  if (::ftruncate(fd_, 0) != 0 ||
      ::pwrite(fd_, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size())) {
    const int error = errno;
    ::unlink(file_.c_str());
    ::close(fd_);
    throw Error("{}: cannot be written ({}); free some space", file_.string(),
                std::strerror(error));
  }
  return true;
}

FileLock::~FileLock() {
  ::unlink(file_.c_str());
  ::close(fd_);
}

FolderLock::Created::Created(const fs::path& path) : folder(path) {
  std::error_code ignored;  // create_folder() says what is wrong
  is_new = !fs::exists(path, ignored);
  create_folder(path);
}

FolderLock::Created::~Created() {
  if (is_new) {
    ::rmdir(folder.c_str());  // fails, as it should, where something is in it
  }
}

FolderLock::FolderLock(const fs::path& folder, const std::string& remedy)
    : created_(folder), lock_(folder / kFolderLock, folder, remedy) {
  sweep_leftovers(folder);
}

}  // namespace clipgs
