#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clipgs {

/// A part of a report: a title, lines of text, then a table; each may be missing. All of it is
/// plain UTF-8, whatever it becomes.
struct ReportBlock {
  std::string title;
  std::vector<std::string> lines;
  std::vector<std::string> header;             ///< of the table
  std::vector<std::vector<std::string>> rows;  ///< as many cells as the header
};

enum class ReportFormat : std::uint8_t { kText, kMarkdown, kLatex };

/// "text", "markdown" or "latex". Throws Error for another name.
ReportFormat parse_report_format(const std::string& name);

/// The blocks one below the other, for a terminal, as Markdown, or as LaTeX to \input (booktabs).
/// Nothing in the text can be taken for markup.
std::string format_report(const std::vector<ReportBlock>& blocks, ReportFormat format);

/// Columns that a text takes on a terminal: its characters.
size_t text_width(std::string_view utf8);

}  // namespace clipgs
