#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace clipgs {

/// Cells of one line, or of several that quotes join.
struct TextRecord {
  size_t line = 0;  ///< where it begins, from 1
  std::vector<std::string> cells;
};

/// A table as it was read.
struct DelimitedText {
  char separator = ',';
  TextRecord header;
  std::vector<TextRecord> records;  ///< each with as many cells as the header
};

/// Reads a table as RFC 4180 has it: cells separated by a comma, a semicolon or a tab, quoted where
/// they hold one, lines that end in LF or CRLF. A UTF-8 mark at the beginning, lines of comment (#)
/// before the header and empty lines are passed over; blanks around a cell are dropped. The
/// separator is the one by which the header has all columns `wanted` (lower case; the header may
/// have capitals). Throws Error, "name:line: …", for text that is not UTF-8, a header without those
/// columns, quotes that do not match, and a record with another number of cells than the header.
DelimitedText read_delimited(std::string_view text, const std::string& name,
                             std::span<const std::string_view> wanted);

/// A cell as a table's text: quoted where it must be.
std::string delimited_cell(std::string_view text, char separator);

/// In ASCII; other letters stay.
std::string ascii_lower(std::string_view text);

/// Whether the text is valid UTF-8 without control characters.
bool is_plain_text(std::string_view text);

}  // namespace clipgs
