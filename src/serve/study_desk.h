#pragma once

#include <filesystem>
#include <string_view>

#include "serve/answer.h"
#include "study/session_log.h"

namespace clipgs {

/// What the viewer asks for while it leads people through a study:
///
///   /study/NAME.json                     a plan, of the folder or one that the program brings
///   /api/study/sessions?participant=7    the participant's sessions as JSON
///   /api/study/sessions/SESSION          its records, a line each; POST (application/jsonl)
///   appends
///
/// Who posts is told how many records the session then has, or, where these do not go on there
/// (409), cannot be written (507) or are not right (422), why.
class StudyDesk {
 public:
  /// The folder holds plans, *.json, and what is recorded; it is made if it is missing. Throws
  /// Error if another program records there.
  explicit StudyDesk(const std::filesystem::path& folder);

  /// Whether a path is one of these.
  static bool is_asked(std::string_view path);
  /// Whether a request brings records, which are to be read before it is answered.
  static bool brings_records(const HttpRequest& request);
  /// Of a path that is_asked(), with the query behind it, "?..." or "".
  void answer(const HttpRequest& request, std::string_view path, std::string_view query,
              Answer& answer);

 private:
  void give_plan(std::string_view name, Answer& answer) const;
  void give_sessions(std::string_view query, Answer& answer);
  void take_records(const HttpRequest& request, const std::string& session, Answer& answer);

  std::filesystem::path folder_;
  SessionLog log_;
};

}  // namespace clipgs
