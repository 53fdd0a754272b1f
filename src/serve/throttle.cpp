#include "serve/throttle.h"

#include <algorithm>

namespace clipgs {

namespace {

constexpr int kTries = 10;
constexpr std::chrono::seconds kForgetOne(6);
constexpr size_t kMaxClients = 4096;

}  // namespace

bool Throttle::is_one_too_many(const std::string& client, Clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  if (until_.size() >= kMaxClients && !until_.contains(client)) {
    std::erase_if(until_, [&](const auto& one) { return one.second <= now; });
    if (until_.size() >= kMaxClients) {
      until_.erase(
          std::ranges::min_element(until_, {}, [](const auto& one) { return one.second; }));
    }
  }
  Clock::time_point& until = until_[client];
  until = std::max(until, now);
  if (until + kForgetOne > now + kTries * kForgetOne) {
    return true;
  }
  until += kForgetOne;
  return false;
}

}  // namespace clipgs
