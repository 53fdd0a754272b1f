#include "serve/study_desk.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "study/built_in_plans.h"

namespace clipgs {

namespace {

namespace http = boost::beast::http;
using http::status;

constexpr std::string_view kPlans = "/study/";
constexpr std::string_view kPlanSuffix = ".json";
constexpr std::string_view kSessions = "/api/study/sessions";
constexpr std::string_view kParticipant = "?participant=";
constexpr const char* kJson = "application/json";
constexpr const char* kRecords = "application/jsonl";
constexpr std::uintmax_t kMostPlan = std::uintmax_t{1} << 20;

}  // namespace

StudyDesk::StudyDesk(const std::filesystem::path& folder) : folder_(folder), log_(folder) {}

bool StudyDesk::is_asked(std::string_view path) {
  return path.starts_with(kPlans) || path.starts_with(kSessions);
}

bool StudyDesk::brings_records(const HttpRequest& request) {
  return request.method() == http::verb::post && target_of(request).starts_with(kSessions);
}

void StudyDesk::answer(const HttpRequest& request, std::string_view path, std::string_view query,
                       Answer& answer) {
  const bool posts = request.method() == http::verb::post;
  if (path.starts_with(kPlans) && !posts) {
    give_plan(path.substr(kPlans.size()), answer);
    return;
  }
  const std::string_view rest = path.substr(std::min(kSessions.size(), path.size()));
  const std::string session(rest.substr(std::min<size_t>(1, rest.size())));
  try {
    if (rest.empty() && !posts) {
      give_sessions(query, answer);
    } else if (!rest.starts_with('/')) {
      fail(answer, status::not_found, "there is no such page of a study");
    } else if (posts) {
      take_records(request, session, answer);
    } else {
      give_text(answer, status::ok, kRecords, log_.read(session));
    }
  } catch (const RefusedRecord& refused) {
    fail(answer, status::unprocessable_entity, refused.what());
  }
}

void StudyDesk::give_plan(std::string_view name, Answer& answer) const {
  const std::string_view stem =
      name.substr(0, name.size() - std::min(kPlanSuffix.size(), name.size()));
  if (name.ends_with(kPlanSuffix) && is_study_name(stem)) {
    const std::filesystem::path own = folder_ / name;
    std::error_code error;
    if (std::filesystem::is_regular_file(own, error)) {
      const std::vector<std::uint8_t> bytes = read_file(own, kMostPlan);
      give_text(answer, status::ok, kJson, {bytes.begin(), bytes.end()});
      return;
    }
    const auto plans = built_in_plans();
    const auto plan = std::ranges::find(plans, stem, &BuiltInPlan::name);
    if (plan != plans.end()) {
      give_text(answer, status::ok, kJson, std::string(plan->json));
      return;
    }
  }
  fail(answer, status::not_found,
       fmt::format("there is no plan {} in {}, nor does clipgs bring one of this name", name,
                   folder_.string()));
}

void StudyDesk::give_sessions(std::string_view query, Answer& answer) {
  int participant = 0;
  if (query.starts_with(kParticipant)) {
    query.remove_prefix(kParticipant.size());
    std::from_chars(query.data(), query.data() + query.size(), participant);
  }
  if (participant < 1) {
    fail(answer, status::bad_request, "ask for the sessions of a participant, ?participant=7");
    return;
  }
  nlohmann::json list = nlohmann::json::array();
  for (const SessionSummary& one : log_.sessions_of(participant)) {
    list.push_back({{"session", one.session},
                    {"plan", one.plan},
                    {"records", one.records},
                    {"ended", one.ended}});
  }
  give_text(answer, status::ok, kJson, list.dump());
}

void StudyDesk::take_records(const HttpRequest& request, const std::string& session,
                             Answer& answer) {
  if (!is_from_own_page(request, kRecords)) {
    fail(answer, status::forbidden, "records come from this server's own pages alone");
    return;
  }
  const auto tell = [&](status what, int records, const std::string& error) {
    nlohmann::json text = {{"records", records}};
    if (!error.empty()) {
      text["error"] = error;
    }
    give_text(answer, what, kJson, text.dump());
  };
  try {
    tell(status::ok, log_.append(session, request.body()), "");
  } catch (const RecordConflict& conflict) {
    tell(status::conflict, conflict.next(), conflict.what());
  } catch (const RefusedRecord&) {
    throw;
  } catch (const Error& error) {
    fail(answer, status::insufficient_storage, error.what());
  }
}

}  // namespace clipgs
