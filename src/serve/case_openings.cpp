#include "serve/case_openings.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"

namespace clipgs {

namespace {

/// `changed`: what of the case was; "": it was opened.
std::string audit_line(const Client& client, const std::string& token, const CaseEntry& entry,
                       const std::string& changed = "") {
  nlohmann::ordered_json line = {{"time", log_time(std::chrono::system_clock::now())},
                                 {"event", changed.empty() ? "opened" : "changed"},
                                 {"client", client.address},
                                 {"token", token},
                                 {"case", entry.name},
                                 {"version", entry.version}};
  if (!changed.empty()) {
    line["what"] = changed;
  }
  return line.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

}  // namespace

CaseOpenings::CaseOpenings(const std::filesystem::path& audit)
    : audit_(audit.empty() ? nullptr : std::make_unique<LogFile>(audit)) {}

void CaseOpenings::note(const Client& client, const std::string& token, const CaseEntry& entry,
                        Clock::time_point now) {
  const std::string key = client.address + '\n' + token + '\n' + entry.version + '\n' + entry.name;
  // Held while it is written: a second request waits until the first one is told of.
  const std::scoped_lock lock(mutex_);
  const auto known = last_.find(key);
  if (known != last_.end() && now - known->second < kRest) {
    known->second = std::max(known->second, now);
    return;
  }
  tell(audit_line(client, token, entry));
  ++count_;
  if (last_.size() >= kMost) {
    forget_old(now);
  }
  last_[key] = now;
}

void CaseOpenings::note_change(const Client& client, const std::string& token,
                               const CaseEntry& entry, const char* what) {
  const std::scoped_lock lock(mutex_);
  tell(audit_line(client, token, entry, what));
}

std::uint64_t CaseOpenings::count() const {
  const std::scoped_lock lock(mutex_);
  return count_;
}

bool CaseOpenings::is_well() {
  const std::scoped_lock lock(mutex_);
  if (!well_) {
    const nlohmann::ordered_json line = {{"time", log_time(std::chrono::system_clock::now())},
                                         {"event", "resumed"}};
    try {
      tell(line.dump());
    } catch (const Error&) {
      return false;
    }
  }
  return true;
}

void CaseOpenings::tell(const std::string& line) {
  if (!audit_) {
    return;
  }
  const bool was_well = std::exchange(well_, false);
  try {
    audit_->write_for_good(line);
  } catch (const Error& error) {
    if (was_well) {
      warn(std::string(error.what()) + "; until then no case is given");
    }
    throw Error(
        "it cannot be recorded who opens or changes this, so nobody can; tell who runs this "
        "server");
  }
  well_ = true;
}

void CaseOpenings::reopen() {
  if (audit_) {
    audit_->reopen();
  }
}

void CaseOpenings::forget_old(Clock::time_point now) {
  std::erase_if(last_, [&](const auto& one) { return now - one.second >= kRest; });
  if (last_.size() >= kMost) {
    last_.clear();
  }
}

}  // namespace clipgs
