#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace clipgs {

/// Between a program that makes cases while it serves them and the pages that look at them: these
/// are told what is made, and it learns whether anybody still looks. Safe to use from several
/// threads.
class LiveWork {
 public:
  using Clock = std::chrono::steady_clock;
  /// A page that has said nothing for so long is gone, however it ended; browsers let pages that
  /// nobody sees speak once in a minute.
  static constexpr std::chrono::seconds kSilence{150};
  /// What a page calls itself has no more letters, and no more pages than this are counted.
  static constexpr size_t kPageName = 64;
  static constexpr size_t kPages = 256;

  /// From now on the case `name` is made in this `quality`, of which it tells how many seconds
  /// `left` there are, if it knows. Cases that wait for their turn are told of as well.
  void begin(const std::string& name, const std::string& quality,
             std::function<std::optional<double>()> left = nullptr);
  /// It is made no more: it is there, or `error` says in a line why not.
  void end(const std::string& name, const std::string& error = "");

  /// [{"name", "quality", "seconds" (where they are known), "error" (of what failed)}, …] in the
  /// order in which the names were first told.
  nlohmann::json json() const;

  /// A page is there, and looks.
  void page_seen(const std::string& page, Clock::time_point now = Clock::now());
  /// It said that it was closed.
  void page_left(const std::string& page, Clock::time_point now = Clock::now());
  /// For how long there has been no page any more; nothing while there is one, or before the first.
  std::optional<Clock::duration> deserted(Clock::time_point now = Clock::now());

 private:
  struct Work {
    std::string name;
    std::string quality;
    std::function<std::optional<double>()> left;
    std::string error;
  };

  mutable std::mutex mutex_;
  std::vector<Work> works_;
  std::map<std::string, Clock::time_point> pages_;  // when they were seen last
  std::optional<Clock::time_point> last_;           // when one was seen, or went, last
};

}  // namespace clipgs
