#include "serve/connections.h"

#include <algorithm>
#include <utility>

namespace clipgs {

Connections::Id Connections::add(const std::string& client, std::function<void()> close) {
  if (ended_) {
    close();
    return ++next_;
  }
  const auto count = count_.find(client);
  if (count != count_.end() && count->second >= limits_.per_client) {
    close_one_of(client);
  } else if (open_.size() >= limits_.all) {
    close_one();
  }
  ++count_[client];
  open_.emplace(++next_, Open{client, std::move(close)});
  return next_;
}

void Connections::remove(Id id) {
  const auto it = open_.find(id);
  if (it == open_.end()) {
    return;
  }
  const auto count = count_.find(it->second.client);
  if (--count->second == 0) {
    count_.erase(count);
  }
  open_.erase(it);
}

void Connections::set_answering(Id id, bool answering) {
  if (const auto it = open_.find(id); it != open_.end()) {
    it->second.answering = answering;
    it->second.since = Clock::now();
  }
}

void Connections::close_all() {
  ended_ = true;
  while (!open_.empty()) {
    const Id id = open_.begin()->first;
    const auto close = std::move(open_.begin()->second.close);
    remove(id);
    close();
  }
}

void Connections::close_one() {
  if (!count_.empty()) {
    const auto most =
        std::ranges::max_element(count_, {}, [](const auto& one) { return one.second; });
    close_one_of(std::string(most->first));
  }
}

void Connections::close_one_of(const std::string& client) {
  auto least = open_.end();
  for (auto it = open_.begin(); it != open_.end(); ++it) {
    const Open& one = it->second;
    if (one.client == client &&
        (least == open_.end() || std::pair(one.answering, one.since) <
                                     std::pair(least->second.answering, least->second.since))) {
      least = it;
    }
  }
  const auto close = std::move(least->second.close);
  remove(least->first);
  close();
}

}  // namespace clipgs
