#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "serve/case_index.h"
#include "serve/client.h"
#include "serve/log_file.h"

namespace clipgs {

/// Who opened which case when, and who changed what lies beside it. Openings are told once for all
/// requests of somebody (an address and a token) for a version of a case, until there was none for
/// kRest. Safe to use from several threads.
class CaseOpenings {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::minutes kRest{15};
  /// More than these are not remembered; who is forgotten is told of again.
  static constexpr size_t kMost = 65'536;

  /// With a file, a line of JSON is there for each (docs/service.md), and on the disk, before the
  /// case is given; "": without one. Throws Error if it cannot be opened.
  explicit CaseOpenings(const std::filesystem::path& audit);

  /// The case is about to be given. Throws Error if that cannot be told; then it must not be.
  void note(const Client& client, const std::string& token, const CaseEntry& entry,
            Clock::time_point now = Clock::now());

  /// Its marks or its tour are about to be changed. Throws Error as note() does.
  void note_change(const Client& client, const std::string& token, const CaseEntry& entry,
                   const char* what);

  std::uint64_t count() const;
  /// Whether openings can be told. Where the last one could not, it is tried anew, by a line that
  /// says so: nobody may ask for a case before it is well.
  bool is_well();
  void reopen();

 private:
  /// Throws Error.
  void tell(const std::string& line);
  void forget_old(Clock::time_point now);

  std::unique_ptr<LogFile> audit_;
  mutable std::mutex mutex_;
  std::map<std::string, Clock::time_point> last_;  ///< requests, by who and what
  std::uint64_t count_ = 0;
  bool well_ = true;
};

}  // namespace clipgs
