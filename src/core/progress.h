#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace clipgs {

/// Progress with the time left, on standard error. On a terminal one line is rewritten; elsewhere
/// (a log file) a line is printed at most every ten seconds. Work under two seconds prints nothing.
/// Call from one thread.
class Progress {
 public:
  Progress(std::string label, size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of `total` are finished; `detail` is shown after the time left, e.g. "loss 0.031".
  void update(size_t done, const std::string& detail = "");

  /// Turns all progress of the process off (tests, --quiet).
  static void set_enabled(bool on);

  /// Is told of every update: the label, and the share that is done, 0…1.
  using Watcher = std::function<void(const std::string& label, double share)>;
  /// Whoever else wants to know how far the process is, even where nothing is printed; null:
  /// nobody. To be set while nothing is updated.
  static void set_watcher(Watcher watcher);

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  size_t total_;
  size_t first_done_ = 0;  // a resumed task does not count what it found done
  bool started_ = false;
  bool shown_ = false;
  Clock::time_point start_;
  Clock::time_point last_print_;
};

/// 75 → "1 min 15 s".
std::string format_duration(double seconds);

}  // namespace clipgs
