#include "study/study_csv.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "study/delimited_text.h"
#include "study/sus.h"

namespace clipgs {

namespace {

constexpr std::array<std::string_view, 2> kKeyColumns{"participant", "mode"};
constexpr size_t kMostColumns = 256;
constexpr size_t kLongestName = 64;  // bytes
/// Squares of larger numbers would leave little to compute with.
constexpr double kLargestNumber = 1e12;

/// What a cell may hold.
struct CellRange {
  double low = -kLargestNumber;
  double high = kLargestNumber;
  bool whole = false;
};
constexpr CellRange kAnswerRange{1, 5, true};
constexpr CellRange kShareRange{0, 100, false};

/// Where the columns are, and what they measure.
struct TableLayout {
  size_t participant = 0;
  size_t mode = 0;
  std::vector<size_t> sus_items;   // all or none
  std::vector<size_t> tlx_scales;  // all or none
  struct Single {
    std::string measure;
    size_t column;
    CellRange range;
  };
  std::vector<Single> singles;
};

CellRange range_of(const std::string& measure) {
  if (measure == "efficiency") {
    return kAnswerRange;
  }
  return measure == "sus" || measure == "tlx" ? kShareRange : CellRange{};
}

/// Reads one table.
class StudyCsvReader {
 public:
  StudyCsvReader(std::string_view text, const std::string& name)
      : name_(name), table_(read_delimited(text, name, kKeyColumns)), layout_(layout()) {}

  StudyTable read() {
    StudyTable result;
    for (const TextRecord& record : table_.records) {
      result.rows.push_back(row(record));
    }
    if (result.rows.empty()) {
      throw Error("{}: has a header, but no rows; give one for each participant and mode", name_);
    }
    if (!layout_.sus_items.empty()) {
      result.measures.emplace_back("sus");
    }
    if (!layout_.tlx_scales.empty()) {
      result.measures.emplace_back("tlx");
    }
    for (const TableLayout::Single& single : layout_.singles) {
      result.measures.push_back(single.measure);
    }
    StudyTable checked;
    join(checked, std::move(result));
    return checked;
  }

 private:
  std::string at(size_t line) const { return fmt::format("{}:{}", name_, line); }

  void require_name(const std::string& text, size_t line, const char* what) const {
    if (text.empty() || text.size() > kLongestName || !is_plain_text(text)) {
      throw Error("{}: a {} is empty, longer than {} bytes or has control characters; name it",
                  at(line), what, kLongestName);
    }
  }

  /// Columns prefix1 … prefixN; none, or all.
  std::vector<size_t> numbered(std::vector<std::string>& names, const std::string& prefix,
                               size_t count) const {
    std::vector<size_t> columns;
    std::string lacking;
    for (size_t i = 1; i <= count; ++i) {
      const auto found = std::ranges::find(names, fmt::format("{}{}", prefix, i));
      if (found == names.end()) {
        lacking = fmt::format("{}{}", prefix, i);
        continue;
      }
      columns.push_back(static_cast<size_t>(found - names.begin()));
      found->clear();
    }
    if (!columns.empty() && !lacking.empty()) {
      throw Error("{}: the header has no column {}; give {}1 to {}{}, or none of them",
                  at(table_.header.line), lacking, prefix, prefix, count);
    }
    return columns;
  }

  TableLayout layout() const {
    const size_t line = table_.header.line;
    if (table_.header.cells.size() > kMostColumns) {
      throw Error("{}: has {} columns; at most {} are read", at(line), table_.header.cells.size(),
                  kMostColumns);
    }
    std::vector<std::string> names;
    for (const std::string& cell : table_.header.cells) {
      require_name(cell, line, "column's name");
      const std::string lower = ascii_lower(cell);
      if (std::ranges::find(names, lower) != names.end()) {
        throw Error("{}: there are two columns \"{}\"; keep one", at(line), lower);
      }
      names.push_back(lower);
    }
    if (std::ranges::find(names, "seq") != names.end() &&
        std::ranges::find(names, "kind") != names.end()) {
      throw Error("{}: is what one session recorded; give the folder of the sessions", at(line));
    }
    TableLayout result;
    const auto take = [&](std::string_view name) {
      const auto found = std::ranges::find(names, name);
      found->clear();
      return static_cast<size_t>(found - names.begin());
    };
    result.participant = take("participant");
    result.mode = take("mode");
    result.sus_items = numbered(names, "q", kSusItems);
    result.tlx_scales = numbered(names, "tlx", kTlxScales);
    for (size_t i = 0; i < names.size(); ++i) {
      if (names[i].empty()) {
        continue;
      }
      if ((names[i] == "sus" && !result.sus_items.empty()) ||
          (names[i] == "tlx" && !result.tlx_scales.empty())) {
        throw Error("{}: there are both \"{}\" and the answers it is made of; keep one", at(line),
                    names[i]);
      }
      result.singles.push_back({names[i], i, range_of(names[i])});
    }
    return result;
  }

  StudyRow row(const TextRecord& record) {
    StudyRow result;
    result.place = at(record.line);
    result.participant = participant(record);
    result.mode = record.cells[layout_.mode];
    require_name(result.mode, record.line, "mode");
    if (const auto answers = all_of(record, layout_.sus_items, "sus", kAnswerRange, result)) {
      std::vector<int> whole(answers->begin(), answers->end());
      result.values["sus"] = sus_score(whole);
    }
    if (const auto scales = all_of(record, layout_.tlx_scales, "tlx", kShareRange, result)) {
      result.values["tlx"] = raw_tlx(*scales);
    }
    for (const TableLayout::Single& single : layout_.singles) {
      if (const auto value = number(record, single.column, single.range)) {
        result.values[single.measure] = *value;
      } else {
        result.missing[single.measure] = fmt::format("no value at {}", result.place);
      }
    }
    return result;
  }

  std::string participant(const TextRecord& record) const {
    std::string name = record.cells[layout_.participant];
    require_name(name, record.line, "participant");
    if (std::ranges::all_of(name, [](char c) { return c >= '0' && c <= '9'; })) {
      name.erase(0, std::min(name.find_first_not_of('0'), name.size() - 1));
    }
    return name;
  }

  /// The answers of a questionnaire; none if it is not asked for or lacks some, as `row` says then.
  std::optional<std::vector<double>> all_of(const TextRecord& record,
                                            const std::vector<size_t>& columns, const char* measure,
                                            const CellRange& range, StudyRow& row) {
    std::vector<double> answers;
    for (const size_t column : columns) {
      if (const auto answer = number(record, column, range)) {
        answers.push_back(*answer);
      } else {
        row.missing.try_emplace(
            measure, fmt::format("no answer to {} at {}", table_.header.cells[column], row.place));
      }
    }
    if (columns.empty() || answers.size() < columns.size()) {
      return std::nullopt;
    }
    row.answers[measure] = answers;
    return answers;
  }

  /// The number in a cell; nothing if it is empty.
  std::optional<double> number(const TextRecord& record, size_t column, const CellRange& range) {
    std::string text = record.cells[column];
    if (text.empty()) {
      return std::nullopt;
    }
    note_decimal_mark(text, record.line);
    if (table_.separator != ',') {
      std::ranges::replace(text, ',', '.');
    }
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string& name = table_.header.cells[column];
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
      throw Error("{}: {} is \"{}\", which is no number; leave the cell of a missing value empty",
                  at(record.line), name, printable(record.cells[column]));
    }
    if (value < range.low || value > range.high || (range.whole && value != std::floor(value))) {
      throw Error("{}: {} is {}, which is no {} from {} to {}; correct it", at(record.line), name,
                  record.cells[column], range.whole ? "whole number" : "number", range.low,
                  range.high);
    }
    return value + 0.0;  // 0 for −0
  }

  /// A comma that separates thousands would be read as a decimal one: a table has one kind of mark.
  void note_decimal_mark(const std::string& text, size_t line) {
    const size_t found = text.find_first_of(table_.separator == ',' ? "." : ".,");
    if (found == std::string::npos) {
      return;
    }
    if (decimal_mark_ != 0 && decimal_mark_ != text[found]) {
      throw Error("{}: \"{}\" has another decimal mark than numbers before it; use one throughout",
                  at(line), printable(text));
    }
    decimal_mark_ = text[found];
  }

  static std::string printable(const std::string& text) {
    return text.size() <= kLongestName && is_plain_text(text) ? text : "(long or binary text)";
  }

  std::string name_;
  DelimitedText table_;
  TableLayout layout_;
  char decimal_mark_ = 0;
};

}  // namespace

StudyTable parse_study_csv(std::string_view text, const std::string& name) {
  return StudyCsvReader(text, name).read();
}

StudyTable read_study_csv(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> bytes = read_file(path, kMostCsvBytes);
  return parse_study_csv({reinterpret_cast<const char*>(bytes.data()), bytes.size()},
                         path.string());
}

}  // namespace clipgs
