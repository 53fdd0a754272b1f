#include "core/progress.h"

#include <atomic>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <unistd.h>

namespace clipgs {

namespace {

std::atomic<bool> enabled{true};

Progress::Watcher& the_watcher() {
  static Progress::Watcher all;
  return all;
}

}  // namespace

std::string format_duration(double seconds) {
  const auto s = std::lround(seconds);
  if (s < 60) {
    return fmt::format("{} s", s);
  }
  if (s < 3600) {
    return fmt::format("{} min {:02} s", s / 60, s % 60);
  }
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

Progress::Progress(std::string label, size_t total)
    : label_(std::move(label)), total_(total), start_(Clock::now()), last_print_(start_) {}

Progress::~Progress() {
  if (shown_ && isatty(STDERR_FILENO) != 0) {
    std::fputc('\n', stderr);
  }
}

void Progress::set_enabled(bool on) { enabled = on; }

void Progress::set_watcher(Watcher watcher) { the_watcher() = std::move(watcher); }

void Progress::update(size_t done, const std::string& detail) {
  if (!started_) {
    started_ = true;
    first_done_ = done;
  }
  const double fraction = total_ == 0 ? 1 : static_cast<double>(done) / static_cast<double>(total_);
  if (the_watcher()) {
    the_watcher()(label_, fraction);
  }
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const auto now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double since_print = std::chrono::duration<double>(now - last_print_).count();
  const bool last = done >= total_;
  const bool due = since_print > (terminal ? 0.2 : 10.0) || (last && shown_);
  if (!enabled || elapsed < 2.0 || !due || total_ == 0) {
    return;
  }
  last_print_ = now;
  shown_ = true;
  const auto fresh = static_cast<double>(done - first_done_);
  std::string left;
  if (last) {
    left = fmt::format("done in {}", format_duration(elapsed));
  } else if (fresh > 0) {
    left = fmt::format("{} left",
                       format_duration(elapsed * static_cast<double>(total_ - done) / fresh));
  }
  const std::string text = fmt::format("{}: {:3.0f} %  {}{}{}", label_, 100.0 * fraction, left,
                                       detail.empty() ? "" : "  ", detail);
  fmt::print(stderr, "{}{}{}", terminal ? "\r\033[K" : "", text, terminal ? "" : "\n");
  std::fflush(stderr);
}

}  // namespace clipgs
