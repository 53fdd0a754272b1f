#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <string>

#include "serve/answer.h"
#include "serve/client.h"
#include "serve/log_file.h"

namespace clipgs {

/// A request, and what came of it.
struct Exchange {
  const HttpRequest& request;
  const Answer& answer;
  const Client& client;
  std::uint64_t bytes = 0;  ///< that were sent, with the head
  std::chrono::steady_clock::duration took{};
};

/// A line of JSON for each request (docs/service.md). It says nothing that lets anybody in: no
/// query, no cookie, no header but the browser's name, and of addresses only those that there are,
/// as others may be a token with a letter wrong.
std::string access_line(const Exchange& exchange, std::chrono::system_clock::time_point now);

/// Where these lines are written. Whatever happens to the file, the server goes on.
class AccessLog {
 public:
  /// Throws Error if the file cannot be opened.
  explicit AccessLog(const std::filesystem::path& file) : file_(file) {}

  void write(const Exchange& exchange);
  void reopen() { file_.reopen(); }

 private:
  LogFile file_;
  std::atomic<bool> failed_ = false;
};

}  // namespace clipgs
