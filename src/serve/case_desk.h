#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "serve/access_tokens.h"
#include "serve/answer.h"
#include "serve/case_index.h"
#include "serve/case_openings.h"
#include "serve/client.h"
#include "serve/companion_desk.h"
#include "serve/live_work.h"
#include "serve/metrics.h"

namespace clipgs {

/// What a desk of cases is told.
struct CaseDeskOptions {
  std::filesystem::path folder;
  bool subfolders = false;      ///< see CaseIndex
  std::set<std::string> only;   ///< see CaseIndex
  LiveWork* live = nullptr;     ///< what is made meanwhile; outlives the desk
  CompanionDesk::Keeps keeps;   ///< what beside cases may be changed
  std::filesystem::path audit;  ///< see CaseOpenings
};

/// Gives the cases, what belongs to them, and the list of them: to each what it may see. Safe to
/// use from several threads.
class CaseDesk {
 public:
  /// Throws Error if the folder is not there, or the audit file cannot be written.
  explicit CaseDesk(const CaseDeskOptions& options);

  /// Whether a request brings something that is kept, which is to be read before it is answered.
  bool is_brought(const HttpRequest& request) const { return companions_.is_brought(request); }

  void give_list(std::string_view query, const Grant& grant, Answer& answer);
  /// `rest`: of the address behind /cases/; `versioned`: it names the version of what it asks for.
  void give_of_case(const HttpRequest& request, std::string_view rest, bool versioned,
                    const Client& client, const Grant& grant, Answer& answer);

  /// Nothing while the folder cannot be read.
  std::optional<Metrics::Cases> count();
  CaseIndex& index() { return index_; }
  CaseOpenings& openings() { return openings_; }

 private:
  void give_companion(const HttpRequest& request, const CompanionDesk::Wanted& wanted,
                      const Client& client, const Grant& grant, Answer& answer);

  LiveWork* live_;
  CaseIndex index_;
  CompanionDesk companions_;
  CaseOpenings openings_;
};

}  // namespace clipgs
