#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "serve/request_kind.h"

namespace clipgs {

/// What a server counts, for those who watch it. Safe to use from several threads.
class Metrics {
 public:
  /// How many cases there are; nothing while the folder cannot be read.
  struct Cases {
    size_t shown = 0;
    size_t broken = 0;
  };

  void answered(RequestKind kind, unsigned status, std::uint64_t bytes);
  void connection_opened() { ++connections_; }
  void connection_closed() { --connections_; }

  /// Prometheus' text format, version 0.0.4.
  std::string text(const std::optional<Cases>& cases, std::uint64_t opened) const;

 private:
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::atomic<std::int64_t> connections_ = 0;
  mutable std::mutex mutex_;  ///< of what follows
  std::map<std::pair<RequestKind, unsigned>, std::uint64_t> requests_;
  std::map<RequestKind, std::uint64_t> bytes_;
};

/// A label's value as that format wants it, without the quotes around it.
std::string metric_label(std::string_view value);

}  // namespace clipgs
