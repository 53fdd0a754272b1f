#include "study/study_sessions.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/file.h"
#include "study/records.h"
#include "study/sus.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostSessionBytes = std::uintmax_t{16} << 20;
constexpr std::array kTaskMeasures{"seconds",     "travel_mm", "rotation_deg",
                                   "head_mm",     "head_deg",  "angle_deg",
                                   "distance_mm", "regrasps",  "frame_ms"};

/// What one mode of a session recorded.
struct ModeRecords {
  std::vector<StudyRecord> tasks;                      // without practice
  std::map<std::string, std::vector<double>> answers;  // by questionnaire
};

struct StudySession {
  fs::path file;
  std::string plan;
  std::string digest;
  std::string participant;
  std::vector<std::string> order;
  bool ended = false;
  std::map<std::string, ModeRecords> modes;
};

void take_answers(StudySession& session, const StudyRecord& record, const std::string& place,
                  std::vector<std::string>& remarks) {
  const std::string questionnaire = record["questionnaire"];
  auto& answers = session.modes[record["mode"]].answers;
  if (answers.contains(questionnaire)) {
    remarks.push_back(
        fmt::format("{}: {} was answered again; the last answers count", place, questionnaire));
  }
  answers[questionnaire] = record["answers"].get<std::vector<double>>();
}

void take_record(StudySession& session, const StudyRecord& record, const std::string& place,
                 std::vector<std::string>& remarks) {
  const std::string kind = record["kind"];
  if (kind == "session") {
    session.plan = record["plan"];
    session.digest = record["digest"];
    session.participant = fmt::format("{}", record["participant"].get<int>());
    session.order = record["order"].get<std::vector<std::string>>();
  } else if (kind == "task" && !record["practice"].get<bool>()) {
    session.modes[record["mode"]].tasks.push_back(record);
  } else if (kind == "answers") {
    take_answers(session, record, place, remarks);
  } else if (kind == "end") {
    session.ended = true;
  }
}

StudySession read_session(const fs::path& file, std::vector<std::string>& remarks) {
  const std::vector<std::uint8_t> bytes = read_file(file, kMostSessionBytes);
  std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  StudySession session;
  session.file = file;
  for (int line = 0; !rest.empty(); ++line) {
    const std::string place = fmt::format("{}:{}", file.string(), line + 1);
    const size_t end = rest.find('\n');
    if (end == std::string_view::npos) {
      remarks.push_back(fmt::format("{}: the last line was cut off, and is left out", place));
      break;
    }
    const StudyRecord record = parse_record(rest.substr(0, end), place);
    rest.remove_prefix(end + 1);
    if (record["seq"] != line || session.ended) {
      throw Error("{}: this is no record {} of a session; take the file as it was written", place,
                  line);
    }
    take_record(session, record, place, remarks);
  }
  if (session.participant.empty()) {
    throw Error("{}: holds no session; remove the file", file.string());
  }
  return session;
}

std::vector<StudySession> read_sessions(const fs::path& folder, std::vector<std::string>& remarks) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".jsonl") {
      files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw Error("{}: there are no sessions (*.jsonl); clipgs serve --study records them",
                folder.string());
  }
  std::ranges::sort(files);
  std::vector<StudySession> sessions;
  for (const fs::path& file : files) {
    sessions.push_back(read_session(file, remarks));
    const StudySession& first = sessions.front();
    const StudySession& last = sessions.back();
    if (last.plan != first.plan) {
      throw Error("{}: is of the plan {}, {} of {}; analyse each in a folder of its own",
                  file.string(), last.plan, first.file.string(), first.plan);
    }
    if (last.digest != first.digest) {
      remarks.push_back(fmt::format("{}: the plan {} was another one then than in {}",
                                    file.string(), last.plan, first.file.string()));
    }
  }
  return sessions;
}

/// The one session of a participant that counts.
const StudySession& session_that_counts(const std::vector<const StudySession*>& sessions,
                                        std::vector<std::string>& remarks) {
  if (sessions.size() == 1) {
    return *sessions.front();
  }
  if (std::ranges::count_if(sessions, &StudySession::ended) != 1) {
    std::vector<std::string> names;
    names.reserve(sessions.size());
    for (const StudySession* session : sessions) {
      names.push_back(session->file.string());
    }
    throw Error("{}: participant {} has {} sessions; keep one of them", fmt::join(names, ", "),
                sessions.front()->participant, sessions.size());
  }
  for (const StudySession* session : sessions) {
    if (!session->ended) {
      remarks.push_back(
          fmt::format("{}: is not finished and left out; participant {} has a finished session",
                      session->file.string(), session->participant));
    }
  }
  return **std::ranges::find_if(sessions, &StudySession::ended);
}

std::optional<double> mean_of_tasks(const std::vector<StudyRecord>& tasks, const char* measure) {
  double sum = 0;
  int count = 0;
  for (const StudyRecord& task : tasks) {
    if (!task[measure].is_null()) {
      sum += task[measure].get<double>();
      ++count;
    }
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

/// The value of a questionnaire's answers.
double score_of(const std::string& questionnaire, const std::vector<double>& answers) {
  if (questionnaire == "sus") {
    return sus_score(std::vector<int>(answers.begin(), answers.end()));
  }
  return questionnaire == "tlx" ? raw_tlx(answers) : answers.front();
}

StudyRow row_of(const StudySession& session, const std::string& mode, const ModeRecords& records) {
  StudyRow row;
  row.participant = session.participant;
  row.mode = mode;
  row.place = session.file.string();
  for (const char* questionnaire : {"sus", "efficiency", "tlx"}) {
    const auto answers = records.answers.find(questionnaire);
    if (answers == records.answers.end()) {
      row.missing[questionnaire] = fmt::format("no answers in {}", row.place);
      continue;
    }
    row.values[questionnaire] = score_of(questionnaire, answers->second);
    if (answers->second.size() > 1) {
      row.answers[questionnaire] = answers->second;
    }
  }
  for (const char* measure : kTaskMeasures) {
    if (const auto mean = mean_of_tasks(records.tasks, measure)) {
      row.values[measure] = *mean;
    } else {
      row.missing[measure] = fmt::format("not measured in {}", row.place);
    }
  }
  return row;
}

void add_session(StudyTable& table, const StudySession& session) {
  for (const auto& [mode, records] : session.modes) {
    if (!session.ended && !records.answers.contains("sus")) {
      table.remarks.push_back(
          fmt::format("{}: is not finished; participant {} is left out in mode {}",
                      session.file.string(), session.participant, mode));
      continue;
    }
    const auto late = std::ranges::count_if(
        records.tasks, [](const StudyRecord& task) { return task["outcome"] == "time"; });
    if (late > 0) {
      table.remarks.push_back(
          fmt::format("{}: {} of {} tasks in mode {} ran out of time; they count as they ended",
                      session.file.string(), late, records.tasks.size(), mode));
    }
    table.rows.push_back(row_of(session, mode, records));
  }
  if (!session.ended && session.modes.empty()) {
    table.remarks.push_back(fmt::format("{}: is not finished; participant {} is left out",
                                        session.file.string(), session.participant));
  }
}

/// The measures that some row has; of the others there is nothing to compare.
std::vector<std::string> measured(const StudyTable& table) {
  std::vector<std::string> measures;
  for (const StudyRow& row : table.rows) {
    for (const auto& [measure, value] : row.values) {
      measures.push_back(measure);
    }
  }
  return measures;
}

}  // namespace

StudyTable read_study_sessions(const std::filesystem::path& folder) {
  StudyTable table;
  const std::vector<StudySession> sessions = read_sessions(folder, table.remarks);
  std::map<std::string, std::vector<const StudySession*>> by_participant;
  for (const StudySession& session : sessions) {
    by_participant[session.participant].push_back(&session);
  }
  for (const auto& [participant, theirs] : by_participant) {
    add_session(table, session_that_counts(theirs, table.remarks));
  }
  if (table.rows.empty()) {
    throw Error("{}: none of {} sessions has a mode that was finished; wait for them",
                folder.string(), sessions.size());
  }
  table.measures = measured(table);
  StudyTable checked;
  join(checked, std::move(table));
  return checked;
}

}  // namespace clipgs
