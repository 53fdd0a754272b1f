#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <sys/types.h>

namespace clipgs {

/// A child of this process that answers one request after another. What is given to it may crash
/// it, hang or want any memory: here that is no more than a missing answer.
class HelperProcess {
 public:
  /// True under the address sanitizer, which reserves more memory than any limit allows.
  static const bool kMemoryIsFree;

  /// Runs in the child, which has a copy of this process's memory and no thread but one.
  using Work = std::function<std::optional<std::string>(std::string request)>;

  /// `most_memory`: bytes that the child may take beyond what this process has, unless
  /// kMemoryIsFree. Throws Error if the system has no room for a process.
  HelperProcess(const Work& work, std::uint64_t most_memory);
  ~HelperProcess();
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  /// Nothing if the work answers nothing, takes longer than `limit`, or ends the child, or if the
  /// answer is longer than `most` bytes. Once it has ended nothing is answered any more.
  std::optional<std::string> ask(const std::string& request, std::uint64_t most,
                                 std::chrono::milliseconds limit);

 private:
  void end();

  int socket_ = -1;
  pid_t child_ = -1;
};

}  // namespace clipgs
