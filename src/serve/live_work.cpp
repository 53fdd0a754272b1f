#include "serve/live_work.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace clipgs {

void LiveWork::begin(const std::string& name, const std::string& quality,
                     std::function<std::optional<double>()> left) {
  const std::scoped_lock lock(mutex_);
  auto work = std::ranges::find(works_, name, &Work::name);
  if (work == works_.end()) {
    work = works_.insert(works_.end(), Work());
  }
  *work = {name, quality, std::move(left), ""};
}

void LiveWork::end(const std::string& name, const std::string& error) {
  const std::scoped_lock lock(mutex_);
  const auto work = std::ranges::find(works_, name, &Work::name);
  if (work == works_.end()) {
    return;
  }
  if (error.empty()) {
    works_.erase(work);
  } else {
    work->left = nullptr;
    work->error = error;
  }
}

nlohmann::json LiveWork::json() const {
  const std::scoped_lock lock(mutex_);
  nlohmann::json result = nlohmann::json::array();
  for (const Work& work : works_) {
    nlohmann::json one = {{"name", work.name}, {"quality", work.quality}};
    if (const auto left = work.left ? work.left() : std::nullopt) {
      one["seconds"] = std::lround(*left);
    }
    if (!work.error.empty()) {
      one["error"] = work.error;
    }
    result.push_back(std::move(one));
  }
  return result;
}

void LiveWork::page_seen(const std::string& page, Clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  if (page.empty() || page.size() > kPageName) {
    return;
  }
  if (pages_.size() < kPages || pages_.contains(page)) {
    pages_[page] = now;
  }
  last_ = now;
}

void LiveWork::page_left(const std::string& page, Clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  if (pages_.erase(page) > 0) {
    last_ = now;
  }
}

std::optional<LiveWork::Clock::duration> LiveWork::deserted(Clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(pages_, [&](const auto& page) { return now - page.second > kSilence; });
  return pages_.empty() && last_ ? std::optional(now - *last_) : std::nullopt;
}

}  // namespace clipgs
