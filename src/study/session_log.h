#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/lock.h"
#include "study/records.h"

namespace clipgs {

/// Records that do not go on where the file ends, or say otherwise what it says already.
class RecordConflict : public Error {
 public:
  RecordConflict(int next, const std::string& message) : Error("{}", message), next_(next) {}
  /// The number of the record that is expected.
  int next() const { return next_; }

 private:
  int next_;
};

/// A session of which something is recorded.
struct SessionSummary {
  std::string session;
  std::string plan;
  int records = 0;
  bool ended = false;
};

/// A folder of what sessions of a study record: of each SESSION.jsonl, which is only ever appended
/// to, a line a record (parse_record()), and SESSION.csv, the same as rows of a table. One program
/// at a time writes there. Safe to use from several threads.
class SessionLog {
 public:
  /// Makes the folder if it is missing. Throws Error if another program records there.
  explicit SessionLog(const std::filesystem::path& folder);

  /// Appends to a session, or begins it, those of the lines that it does not have yet, and returns
  /// the number of records that it then has. When this returns, they are on the disk: the same
  /// lines may be given again, as after a lost connection, and are recorded once. Throws
  /// RefusedRecord for a name or a line that is not right, RecordConflict for one that does not go
  /// on where the session is, and Error where they cannot be written; what the session had stays,
  /// and nothing is added.
  int append(const std::string& session, std::string_view lines);

  /// All lines of a session; "" if there is none.
  std::string read(const std::string& session);
  /// Of one participant, by their names.
  std::vector<SessionSummary> sessions_of(int participant);

 private:
  using Lines = std::vector<std::string>;

  std::filesystem::path file_of(const std::string& session, const char* ending) const;
  Lines& lines_of(const std::string& session);
  void write(const std::string& session, const Lines& lines, size_t first) const;
  void complete_table(const std::string& session, const Lines& lines) const;

  FolderLock lock_;
  std::mutex mutex_;
  std::map<std::string, Lines> sessions_;  // as the files are
};

/// Whether this can name a session: "p" and the participant's number in at least three digits, a
/// stroke and eight hexadecimal digits, "p007-3f9c2a1b".
bool is_session_name(std::string_view text);

}  // namespace clipgs
