#include "study/delimited_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <utility>

#include "core/error.h"
#include "core/utf8.h"

namespace clipgs {

namespace {

constexpr std::array kSeparators{',', ';', '\t'};
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_blank(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

/// Goes through a text and counts its lines.
class TableScanner {
 public:
  TableScanner(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {
    if (rest_.starts_with(kByteOrderMark)) {
      rest_.remove_prefix(kByteOrderMark.size());
    }
  }

  bool done() const { return rest_.empty(); }
  std::string_view rest() const { return rest_; }
  size_t line() const { return line_; }
  std::string_view current_line() const { return rest_.substr(0, rest_.find('\n')); }

  void skip_line() {
    const size_t end = rest_.find('\n');
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++line_;
  }
  void skip_empty_lines() {
    while (!done() && without_blanks(current_line()).empty()) {
      skip_line();
    }
  }

  /// The record that begins here; the scanner moves behind it.
  TextRecord record(char separator) {
    TextRecord result{line_, {}};
    for (bool more = true; more;) {
      result.cells.push_back(cell(separator));
      more = !done() && rest_.front() == separator;
      if (!done()) {
        line_ += more ? 0 : 1;
        rest_.remove_prefix(1);
      }
    }
    return result;
  }

 private:
  /// One cell; what remains begins with what ends it.
  std::string cell(char separator) {
    const auto skip_blanks = [&] {
      while (!done() && is_blank(rest_.front()) && rest_.front() != separator) {
        rest_.remove_prefix(1);
      }
    };
    skip_blanks();
    if (!done() && rest_.front() == '"') {
      std::string text = quoted();
      skip_blanks();
      if (!done() && rest_.front() != separator && rest_.front() != '\n') {
        throw Error("{}:{}: there is text behind a quoted cell; double the quotes inside it", name_,
                    line_);
      }
      return text;
    }
    const size_t end = std::min(rest_.find_first_of(std::string{separator, '\n'}), rest_.size());
    const std::string text(without_blanks(rest_.substr(0, end)));
    rest_.remove_prefix(end);
    if (text.find('"') != std::string::npos) {
      throw Error("{}:{}: there is a quote inside a cell; quote the cell and double it", name_,
                  line_);
    }
    return text;
  }

  std::string quoted() {
    const size_t begin = line_;
    std::string text;
    rest_.remove_prefix(1);
    while (true) {
      const size_t end = rest_.find('"');
      if (end == std::string_view::npos) {
        throw Error("{}:{}: a quote is not closed; close it", name_, begin);
      }
      const std::string_view part = rest_.substr(0, end);
      text += part;
      line_ += static_cast<size_t>(std::ranges::count(part, '\n'));
      rest_.remove_prefix(end + 1);
      if (!rest_.starts_with('"')) {
        return text;
      }
      text += '"';
      rest_.remove_prefix(1);
    }
  }

  std::string_view rest_;
  std::string name_;
  size_t line_ = 1;
};

bool has_columns(const TextRecord& header, std::span<const std::string_view> wanted) {
  return std::ranges::all_of(wanted, [&](std::string_view column) {
    return std::ranges::any_of(
        header.cells, [&](const std::string& cell) { return ascii_lower(cell) == column; });
  });
}

void require_utf8(std::string_view text, const std::string& name) {
  size_t line = 1;
  while (!text.empty()) {
    const size_t length = utf8_length(text);
    if (length == 0) {
      throw Error("{}:{}: is not UTF-8; save the table as UTF-8 text", name, line);
    }
    line += text.front() == '\n' ? 1 : 0;
    text.remove_prefix(length);
  }
}

}  // namespace

DelimitedText read_delimited(std::string_view text, const std::string& name,
                             std::span<const std::string_view> wanted) {
  require_utf8(text, name);
  TableScanner start(text, name);
  start.skip_empty_lines();
  while (!start.done() && start.rest().starts_with('#')) {
    start.skip_line();
    start.skip_empty_lines();
  }
  for (const char separator : kSeparators) {
    TableScanner scanner = start;
    DelimitedText result{separator, scanner.record(separator), {}};
    if (!has_columns(result.header, wanted)) {
      continue;
    }
    for (scanner.skip_empty_lines(); !scanner.done(); scanner.skip_empty_lines()) {
      result.records.push_back(scanner.record(separator));
      const TextRecord& last = result.records.back();
      if (last.cells.size() != result.header.cells.size()) {
        throw Error("{}:{}: has {} cells, the header {}; give every row a cell for each column",
                    name, last.line, last.cells.size(), result.header.cells.size());
      }
    }
    return result;
  }
  throw Error(
      "{}:{}: the header has no columns \"{}\"; name them, separated by commas, semicolons or tabs",
      name, start.line(), fmt::join(wanted, "\" and \""));
}

std::string delimited_cell(std::string_view text, char separator) {
  if (text.find_first_of("\"\n\r#") == std::string_view::npos &&
      text.find(separator) == std::string_view::npos && without_blanks(text) == text) {
    return std::string(text);
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted += c;
    if (c == '"') {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string ascii_lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') {
      c = static_cast<char>(c - 'A' + 'a');
    }
  }
  return result;
}

bool is_plain_text(std::string_view text) {
  while (!text.empty()) {
    const size_t length = utf8_length(text);
    const auto lead = static_cast<std::uint8_t>(text.front());
    if (length == 0 || lead < 0x20 || lead == 0x7F) {
      return false;
    }
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace clipgs
