#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace clipgs {

/// Counts the wrong tries of each client: some at once, then one every few seconds. Safe to use
/// from several threads; takes little memory however many clients there are.
class Throttle {
 public:
  using Clock = std::chrono::steady_clock;

  /// Counts one more of `client`; returns whether these are too many.
  bool is_one_too_many(const std::string& client, Clock::time_point now = Clock::now());

 private:
  std::mutex mutex_;
  /// Until when the tries of each client so far count.
  std::map<std::string, Clock::time_point> until_;
};

}  // namespace clipgs
