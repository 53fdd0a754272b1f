#include "study/report_blocks.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <span>
#include <utility>

#include "core/error.h"

namespace clipgs {

namespace {

using Replacement = std::pair<std::string_view, std::string_view>;

std::string replace_all(std::string_view text, std::span<const Replacement> replacements) {
  std::string result;
  while (!text.empty()) {
    const auto found = std::ranges::find_if(
        replacements, [&](const Replacement& one) { return text.starts_with(one.first); });
    if (found == replacements.end()) {
      result += text.front();
      text.remove_prefix(1);
    } else {
      result += found->second;
      text.remove_prefix(found->first.size());
    }
  }
  return result;
}

std::string markdown_text(std::string_view text) {
  constexpr std::array<Replacement, 9> kReplacements{{{"\\", "\\\\"},
                                                      {"|", "\\|"},
                                                      {"*", "\\*"},
                                                      {"_", "\\_"},
                                                      {"`", "\\`"},
                                                      {"[", "\\["},
                                                      {"]", "\\]"},
                                                      {"<", "&lt;"},
                                                      {"&", "&amp;"}}};
  return replace_all(text, kReplacements);
}

std::string latex_text(std::string_view text) {
  constexpr std::array<Replacement, 21> kReplacements{{{"d_z", "$d_z$"},
                                                       {"--", "-{}-"},
                                                       {"π", "$\\pi$"},
                                                       {"\\", "\\textbackslash{}"},
                                                       {"{", "\\{"},
                                                       {"}", "\\}"},
                                                       {"$", "\\$"},
                                                       {"&", "\\&"},
                                                       {"#", "\\#"},
                                                       {"%", "\\%"},
                                                       {"_", "\\_"},
                                                       {"^", "\\textasciicircum{}"},
                                                       {"~", "\\textasciitilde{}"},
                                                       {"<", "$<$"},
                                                       {">", "$>$"},
                                                       {"±", "$\\pm$"},
                                                       {"−", "$-$"},
                                                       {"–", "--"},
                                                       {"°", "$^\\circ$"},
                                                       {"α", "$\\alpha$"},
                                                       {"≥", "$\\geq$"}}};
  return replace_all(text, kReplacements);
}

std::string text_table(const ReportBlock& block) {
  std::vector<size_t> widths;
  for (size_t column = 0; column < block.header.size(); ++column) {
    size_t width = text_width(block.header[column]);
    for (const auto& row : block.rows) {
      width = std::max(width, text_width(row[column]));
    }
    widths.push_back(width);
  }
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text = " ";
    for (size_t column = 0; column < cells.size(); ++column) {
      text += ' ' + cells[column];
      if (column + 1 < cells.size()) {
        text.append(widths[column] - text_width(cells[column]) + 1, ' ');
      }
    }
    return text + '\n';
  };
  std::string text = line(block.header);
  std::string rule = " ";
  for (const size_t width : widths) {
    rule += ' ';
    for (size_t i = 0; i < width; ++i) {
      rule += "─";
    }
    rule += ' ';
  }
  rule.pop_back();
  text += rule + '\n';
  for (const auto& row : block.rows) {
    text += line(row);
  }
  return text;
}

std::string text_block(const ReportBlock& block) {
  std::string text = block.title.empty() ? "" : block.title + '\n';
  for (const std::string& line : block.lines) {
    text += fmt::format("  {}\n", line);
  }
  return block.header.empty() ? text : text + text_table(block);
}

std::string markdown_block(const ReportBlock& block) {
  std::string text =
      block.title.empty() ? std::string() : fmt::format("## {}\n\n", markdown_text(block.title));
  for (const std::string& line : block.lines) {
    text += fmt::format("- {}\n", markdown_text(line));
  }
  if (block.header.empty()) {
    return text;
  }
  const auto line = [](const std::vector<std::string>& cells) {
    std::string row = "|";
    for (const std::string& cell : cells) {
      row += fmt::format(" {} |", markdown_text(cell));
    }
    return row + '\n';
  };
  text += fmt::format("{}{}|", block.lines.empty() ? "" : "\n", line(block.header));
  for (size_t i = 0; i < block.header.size(); ++i) {
    text += "---|";
  }
  text += '\n';
  for (const auto& row : block.rows) {
    text += line(row);
  }
  return text;
}

std::string latex_block(const ReportBlock& block) {
  std::string text = block.title.empty()
                         ? std::string()
                         : fmt::format("\\paragraph{{{}}}\n", latex_text(block.title));
  if (!block.lines.empty()) {
    text += "\\begin{itemize}\n";
    for (const std::string& line : block.lines) {
      text += fmt::format("  \\item {}\n", latex_text(line));
    }
    text += "\\end{itemize}\n";
  }
  if (block.header.empty()) {
    return text;
  }
  const auto line = [](const std::vector<std::string>& cells) {
    std::string row;
    for (const std::string& cell : cells) {
      // A bracket behind a line's end would be read as its option.
      row += (row.empty() ? "  {}" : " & ") + latex_text(cell);
    }
    return row + " \\\\\n";
  };
  text += "\n\\begin{tabular}{" + std::string(block.header.size(), 'l') + "}\n  \\toprule\n" +
          line(block.header) + "  \\midrule\n";
  for (const auto& row : block.rows) {
    text += line(row);
  }
  return text + "  \\bottomrule\n\\end{tabular}\n";
}

}  // namespace

ReportFormat parse_report_format(const std::string& name) {
  constexpr std::array kNames{"text", "markdown", "latex"};
  const auto* const found = std::ranges::find(kNames, name);
  if (found == kNames.end()) {
    throw Error("there is no format {}; choose text, markdown or latex", name);
  }
  return static_cast<ReportFormat>(found - kNames.begin());
}

size_t text_width(std::string_view utf8) {
  return static_cast<size_t>(std::ranges::count_if(
      utf8, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

std::string format_report(const std::vector<ReportBlock>& blocks, ReportFormat format) {
  std::string text;
  if (format == ReportFormat::kLatex) {
    text = "% \\usepackage{booktabs}\n";
  }
  for (const ReportBlock& block : blocks) {
    text += &block == &blocks.front() ? "" : "\n";
    text += format == ReportFormat::kText       ? text_block(block)
            : format == ReportFormat::kMarkdown ? markdown_block(block)
                                                : latex_block(block);
  }
  return text;
}

}  // namespace clipgs
