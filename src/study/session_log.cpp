#include "study/session_log.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t kMostBytes = std::uintmax_t{64} << 20;
constexpr const char* kLines = ".jsonl";
constexpr const char* kTable = ".csv";

bool is_digits(std::string_view text, std::string_view digits) {
  return !text.empty() && text.find_first_not_of(digits) == std::string_view::npos;
}

int participant_of(std::string_view session) {
  int number = 0;
  std::from_chars(session.data() + 1, session.data() + session.find('-'), number);
  return number;
}

/// Whole lines, without their ends.
std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> lines;
  for (size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
    lines.push_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  return lines;
}

/// A file that is appended to, all or nothing.
class Appended {
 public:
  explicit Appended(const fs::path& path)
      : path_(path), fd_(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644)) {
    struct stat status{};
    if (fd_ < 0 || ::fstat(fd_, &status) != 0) {
      fail();
    }
    size_ = status.st_size;
  }
  ~Appended() { ::close(fd_); }
  Appended(const Appended&) = delete;
  Appended& operator=(const Appended&) = delete;

  void cut_off(size_t size) {
    size_ = static_cast<off_t>(size);
    if (::ftruncate(fd_, size_) != 0 || ::fsync(fd_) != 0) {
      fail();
    }
  }

  void append(std::string_view text) {
    std::string_view rest = text;
    while (!rest.empty()) {
      const ssize_t n = ::write(fd_, rest.data(), rest.size());
      if (n < 0 && errno == EINTR) {
        continue;
      }
      if (n <= 0) {
        undo();
      }
      rest.remove_prefix(static_cast<size_t>(n));
    }
    if (::fsync(fd_) != 0) {
      undo();
    }
    size_ += static_cast<off_t>(text.size());
  }

 private:
  [[noreturn]] void undo() {
    const int error = errno;
    if (::ftruncate(fd_, size_) == 0) {
      ::fsync(fd_);
    }
    errno = error;
    fail();
  }
  [[noreturn]] void fail() const {
    throw Error(
        "{}: cannot be written ({}); what was recorded stays; make room or choose another folder",
        path_.string(), std::strerror(errno));
  }

  fs::path path_;
  int fd_ = -1;
  off_t size_ = 0;
};

/// Makes a new file's name survive a power cut.
void sync(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd >= 0) {
    ::fsync(fd);
    ::close(fd);
  }
}

/// The text of a file; "" if there is none.
std::string text_of(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    return {};
  }
  const std::vector<std::uint8_t> bytes = read_file(path, kMostBytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

bool is_session_name(std::string_view text) {
  const size_t stroke = text.find('-');
  if (stroke == std::string_view::npos || text.front() != 'p') {
    return false;
  }
  constexpr size_t kHash = 8;
  const std::string_view number = text.substr(1, stroke - 1);
  const std::string_view hash = text.substr(stroke + 1);
  return (number.size() == 3 || (number.size() == 4 && number.front() != '0')) &&
         is_digits(number, "0123456789") && number != "000" && hash.size() == kHash &&
         is_digits(hash, "0123456789abcdef");
}

SessionLog::SessionLog(const fs::path& folder)
    : lock_(folder, "choose another folder for this study's records") {}

fs::path SessionLog::file_of(const std::string& session, const char* ending) const {
  return lock_.folder() / (session + ending);
}

SessionLog::Lines& SessionLog::lines_of(const std::string& session) {
  if (!is_session_name(session)) {
    throw RefusedRecord("{}: this names no session of a study", session);
  }
  const auto known = sessions_.find(session);
  if (known != sessions_.end()) {
    return known->second;
  }
  const fs::path path = file_of(session, kLines);
  const std::string text = text_of(path);
  Lines lines;
  size_t whole = 0;
  for (const std::string_view line : split(text)) {
    lines.emplace_back(line);
    whole += line.size() + 1;
  }
  // What a power cut left of a line was never said to be recorded; it will be sent again.
  if (whole < text.size()) {
    Appended(path).cut_off(whole);
  }
  return sessions_.emplace(session, std::move(lines)).first->second;
}

int SessionLog::append(const std::string& session, std::string_view lines) {
  const std::scoped_lock guard(mutex_);
  Lines& known = lines_of(session);
  Lines all = known;
  if (!lines.ends_with('\n')) {
    throw RefusedRecord("{}: the last record is cut off", session);
  }
  for (const std::string_view line : split(lines)) {
    const StudyRecord record = parse_record(line, session);
    const size_t seq = record["seq"];
    const std::string text = record.dump();
    const int next = static_cast<int>(all.size());
    if (seq == 0 && record["participant"] != participant_of(session)) {
      throw RefusedRecord("{}: is the session of another participant", session);
    }
    if (seq > all.size()) {
      throw RecordConflict(next, fmt::format("{}: record {} is missing", session, next));
    }
    if (seq < all.size() && all[seq] != text) {
      throw RecordConflict(
          next, fmt::format("{}: record {} is another; is this session held in two places?",
                            session, seq));
    }
    if (seq == all.size()) {
      if (!all.empty() && parse_record(all.back(), session)["kind"] == "end") {
        throw RecordConflict(next, fmt::format("{}: the session has ended", session));
      }
      all.push_back(text);
    }
  }
  write(session, all, known.size());
  known = std::move(all);
  return static_cast<int>(known.size());
}

void SessionLog::write(const std::string& session, const Lines& lines, size_t first) const {
  if (first < lines.size()) {
    std::string text;
    for (size_t i = first; i < lines.size(); ++i) {
      text += lines[i] + '\n';
    }
    Appended(file_of(session, kLines)).append(text);
    sync(lock_.folder());
  }
  complete_table(session, lines);
}

/// Appends to the table what it lacks. It follows from the lines: where it is otherwise, as after a
/// power cut, it is made anew.
void SessionLog::complete_table(const std::string& session, const Lines& lines) const {
  std::string table = csv_header_of_records() + '\n';
  for (const std::string& line : lines) {
    table += csv_of_record(parse_record(line, session)) + '\n';
  }
  const fs::path path = file_of(session, kTable);
  try {
    const std::string there = text_of(path);
    if (table.starts_with(there)) {
      Appended(path).append(std::string_view(table).substr(there.size()));
    } else {
      write_text(path, table);
    }
  } catch (const Error& error) {
    // The records themselves are safe; the table is completed with the next one.
    warn(error.what());
  }
}

std::string SessionLog::read(const std::string& session) {
  const std::scoped_lock guard(mutex_);
  std::string text;
  for (const std::string& line : lines_of(session)) {
    text += line + '\n';
  }
  return text;
}

std::vector<SessionSummary> SessionLog::sessions_of(int participant) {
  const std::scoped_lock guard(mutex_);
  std::vector<SessionSummary> result;
  for (const auto& entry : fs::directory_iterator(lock_.folder())) {
    const std::string session = entry.path().stem().string();
    if (entry.path().extension() != kLines || !is_session_name(session) ||
        participant_of(session) != participant) {
      continue;
    }
    const Lines& lines = lines_of(session);
    if (!lines.empty()) {
      const StudyRecord first = parse_record(lines.front(), session);
      const StudyRecord last = parse_record(lines.back(), session);
      result.push_back(
          {session, first["plan"], static_cast<int>(lines.size()), last["kind"] == "end"});
    }
  }
  std::ranges::sort(result, {}, &SessionSummary::session);
  return result;
}

}  // namespace clipgs
