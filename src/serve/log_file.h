#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>

namespace clipgs {

/// A file that grows by lines, each written at once at its end (O_APPEND), whoever else writes
/// there. Others than its owner and group cannot read it. Safe to use from several threads.
class LogFile {
 public:
  /// "-": standard error. Throws Error if it cannot be opened.
  explicit LogFile(std::filesystem::path file);
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  /// Throws Error if the line is not there now. A file that was removed meanwhile is made anew.
  void write(std::string_view line);
  /// The same; then it is on the disk, too (fsync).
  void write_for_good(std::string_view line);
  /// Goes on in a new file where the old one was renamed, as logrotate does. Throws Error if that
  /// cannot be opened; the old one goes on then.
  void reopen();

 private:
  void append(std::string_view line, bool for_good);

  std::filesystem::path file_;
  std::mutex mutex_;
  int fd_ = -1;
  bool torn_ = false;  ///< what was written last ends within a line
};

/// "2026-11-28T17:13:03.123Z".
std::string log_time(std::chrono::system_clock::time_point time);

}  // namespace clipgs
