#include "serve/log_file.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/chrono.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "core/error.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr mode_t kOwnerAndGroup = 0640;

int open_log(const fs::path& file) {
  if (file == "-") {
    return STDERR_FILENO;
  }
  const int fd =
      ::open(file.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOCTTY, kOwnerAndGroup);
  if (fd < 0) {
    throw Error("{}: cannot be written ({}); choose a file that you can write to", file.string(),
                std::strerror(errno));
  }
  return fd;
}

void close_log(int fd) {
  if (fd != STDERR_FILENO) {
    ::close(fd);
  }
}

}  // namespace

LogFile::LogFile(fs::path file)
    : file_(file == "-" ? std::move(file) : fs::absolute(file)), fd_(open_log(file_)) {}

LogFile::~LogFile() { close_log(fd_); }

void LogFile::write(std::string_view line) { append(line, false); }

void LogFile::write_for_good(std::string_view line) { append(line, true); }

void LogFile::reopen() {
  const std::scoped_lock lock(mutex_);
  const int fd = open_log(file_);
  close_log(fd_);
  fd_ = fd;
  torn_ = false;
}

void LogFile::append(std::string_view line, bool for_good) {
  const std::scoped_lock lock(mutex_);
  struct stat status{};
  if (::fstat(fd_, &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink == 0) {
    const int fd = open_log(file_);
    close_log(fd_);
    fd_ = fd;
    torn_ = false;
  }
  const std::string text = (torn_ ? "\n" : "") + std::string(line) + "\n";
  ssize_t n = 0;
  do {
    n = ::write(fd_, text.data(), text.size());
  } while (n < 0 && errno == EINTR);
  if (n > 0) {
    torn_ = std::cmp_less(n, text.size());
  }
  // What is no file, as a pipe, has no disk to be on.
  const bool whole = n >= 0 && std::cmp_equal(n, text.size());
  if (!whole || (for_good && ::fdatasync(fd_) != 0 && errno != EINVAL && errno != EROFS)) {
    throw Error("{}: cannot be written ({}); make room there", file_.string(),
                whole || n < 0 ? std::strerror(errno) : "no space is left");
  }
}

std::string log_time(std::chrono::system_clock::time_point time) {
  const auto since = time.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since);
  return fmt::format(
      "{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(static_cast<std::time_t>(seconds.count())),
      std::chrono::duration_cast<std::chrono::milliseconds>(since - seconds).count());
}

}  // namespace clipgs
