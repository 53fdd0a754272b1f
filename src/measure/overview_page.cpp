#include "measure/overview_page.h"

#include <algorithm>
#include <fmt/format.h>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/file.h"
#include "core/percent.h"
#include "measure/html.h"
#include "measure/outliers.h"
#include "measure/overview_figures.h"
#include "measure/overview_style.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;
using State = OverviewEntry::State;

constexpr const char* kHead = R"html(<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="referrer" content="no-referrer">
<title>Overview of cases · clipgs</title>
)html";

std::string paragraph(const char* style, const std::string& text) {
  return fmt::format("<p class=\"{}\">{}</p>", style, escape_html(text));
}

/// Key of a figure in the rows' data.
std::string key_of(size_t which) { return fmt::format("f{}", which); }

std::string picture_cell(const OverviewEntry& entry) {
  if (entry.thumbnail.empty()) {
    return R"(<td class="picture"><span></span></td>)";
  }
  return fmt::format(
      "<td class=\"picture\"><img loading=\"lazy\" decoding=\"async\" width=\"128\" height=\"96\" "
      "alt=\"\" src=\"{}.webp\"></td>",
      percent_encode(entry.name));
}

std::string name_cell(const OverviewEntry& entry) {
  const bool opens = !entry.thumbnail.empty();
  const std::string name = escape_html(entry.name);
  std::string about = entry.title;
  for (const std::string& fact : {entry.region, entry.preset, entry.created}) {
    about += (about.empty() || fact.empty() ? "" : " · ") + fact;
  }
  std::string html =
      fmt::format(R"(<th scope="row"><b{}>{}</b><small>{}</small>)",
                  opens ? fmt::format(R"( data-case="{}")", name) : "", name, escape_html(about));
  if (entry.has_report) {
    html += fmt::format(R"(<a href="{}.html" aria-label="Report of {}">Report</a>)",
                        percent_encode(entry.name), name);
  }
  return html + "</th>";
}

std::string why_cell(const OverviewEntry& entry) {
  std::string html = "<td class=\"why\">";
  if (entry.state == State::kFailed) {
    html += paragraph("bad", "Failed. " + entry.failure);
  } else if (entry.state == State::kUnfinished) {
    html += paragraph("quiet", "Not finished.");
  }
  for (const std::string& reason : entry.reasons) {
    html += paragraph("odd", "Stands out: " + reason + ".");
  }
  for (const std::string& note : entry.notes) {
    html += fmt::format("<small>{}</small>", escape_html(note));
  }
  return html + "</td>";
}

/// What the filter knows the row by.
std::string kinds_of(const OverviewEntry& entry) {
  std::string kinds = entry.state == State::kFailed       ? "failed"
                      : entry.state == State::kUnfinished ? "unfinished"
                                                          : "done";
  kinds += entry.reasons.empty() ? "" : " odd";
  kinds += entry.notes.empty() ? "" : " noted";
  return kinds;
}

std::string row_html(const OverviewEntry& entry, size_t rank) {
  std::string data = fmt::format(R"(data-name="{0}" data-kind="{1}" data-rank="{2}")",
                                 escape_html(entry.name), kinds_of(entry), rank);
  std::string cells = picture_cell(entry) + name_cell(entry) + why_cell(entry);
  for (size_t which = 0; which < kFigures; ++which) {
    const FigureKind& kind = figure_kind(which);
    const std::optional<double>& value = entry.figures[which];
    const std::string text =
        value ? fmt::format("{:.{}f}", *value * kind.scale, kind.decimals) : "–";
    cells += fmt::format(R"(<td{} data-label="{}">{}</td>)", value ? "" : R"( class="none")",
                         kind.title, text);
    if (value) {
      data += fmt::format(R"( data-{}="{:.6g}")", key_of(which), *value);
    }
  }
  return fmt::format("<tr {}>{}</tr>\n", data, cells);
}

std::string head_cell(const std::string& key, const char* title, const char* style = "") {
  return fmt::format(R"(<th scope="col"{} data-key="{}"><button type="button">{}</button></th>)",
                     style, key, title);
}

std::string table_html(const std::vector<OverviewEntry>& entries) {
  std::string html = R"(<div class="scroll"><table><thead><tr><td class="picture"></td>)" +
                     head_cell("name", "Case", R"( class="case")") +
                     head_cell("rank", "What stands out", R"( class="case" aria-sort="ascending")");
  for (size_t which = 0; which < kFigures; ++which) {
    html += head_cell(key_of(which), figure_kind(which).title);
  }
  html += "</tr></thead>\n<tbody>\n";
  for (size_t i = 0; i < entries.size(); ++i) {
    html += row_html(entries[i], i);
  }
  return html + "</tbody></table></div>\n";
}

std::string form_html() {
  std::string orders =
      "<option value=\"rank up\">What stands out first</option><option value=\"name up\">Name"
      "</option>";
  for (size_t which = 0; which < kFigures; ++which) {
    const FigureKind& kind = figure_kind(which);
    for (const auto& [way, words] : {std::pair{"up", "least"}, std::pair{"down", "most"}}) {
      orders += fmt::format("<option value=\"{} {}\">{}, {} first</option>", key_of(which), way,
                            kind.title, words);
    }
  }
  return fmt::format(
      "<form hidden><label>Search<input type=\"search\" name=\"words\" autocomplete=\"off\" "
      "placeholder=\"name, title, region, warning …\"></label>"
      "<label>Show<select name=\"kind\"><option value=\"\">All cases</option>"
      "<option value=\"failed\">Failed</option><option value=\"odd\">What stands out</option>"
      "<option value=\"noted\">With warnings</option>"
      "<option value=\"unfinished\">Not finished</option><option value=\"done\">Finished</option>"
      "</select></label><label>Order<select name=\"order\">{}</select></label>"
      "<output role=\"status\" class=\"quiet\"></output></form>\n",
      orders);
}

std::string summary_html(const std::vector<OverviewEntry>& entries) {
  const auto count = [&](auto&& is) { return std::ranges::count_if(entries, is); };
  const auto in_state = [&](State state) {
    return count([state](const OverviewEntry& entry) { return entry.state == state; });
  };
  std::string html = fmt::format(
      "<p>{} cases: {} finished, {} failed, {} not finished; {} stand out.</p>\n", entries.size(),
      in_state(State::kDone), in_state(State::kFailed), in_state(State::kUnfinished),
      count([](const OverviewEntry& entry) { return !entry.reasons.empty(); }));
  std::string medians;
  for (size_t which = 0; which < kFigures; ++which) {
    std::vector<std::optional<double>> values;
    values.reserve(entries.size());
    for (const OverviewEntry& entry : entries) {
      values.push_back(entry.state == State::kDone ? entry.figures[which] : std::nullopt);
    }
    if (const std::optional<double> median = median_of(values)) {
      medians += fmt::format("{}{} {}", medians.empty() ? "" : ", ", figure_kind(which).in_words,
                             figure_text(which, median));
    }
  }
  if (!medians.empty()) {
    html += paragraph("quiet", "Medians: " + medians + ".");
  }
  return html;
}

std::string definitions_html() {
  std::string html = "<h2>What the columns mean</h2>\n<dl>\n";
  for (size_t which = 0; which < kFigures; ++which) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", figure_kind(which).title,
                        figure_kind(which).meaning);
  }
  return html +
         fmt::format(
             "<dt>What stands out</dt><dd>Failed cases; then figures that lie more than {} robust "
             "standard deviations (from the median of the absolute deviations) to the worse side "
             "of the median of all finished cases, or for Gaussians and MB to either; half a "
             "decibel and a fifth count as one deviation at least.</dd>\n</dl>\n",
             kStandsOut);
}

/// Unless it is there: of a thousand, few change.
void write_picture(const fs::path& path, const Bytes& picture) {
  std::error_code error;
  const bool same = fs::file_size(path, error) == picture.size() && !error &&
                    read_file(path, picture.size()) == picture;
  if (!picture.empty() && !same) {
    write_file(path, picture.data(), picture.size());
  }
}

}  // namespace

std::string_view overview_script() { return kOverviewScript; }

std::string overview_page(const std::vector<OverviewEntry>& entries) {
  std::string html = kHead;
  html += fmt::format("<style>{}</style></head>\n<body><main>\n", kOverviewStyle);
  html += "<span class=\"badge\">Not for diagnosis</span>\n<h1>Overview of cases</h1>\n";
  html += summary_html(entries) + form_html() + table_html(entries) + definitions_html();
  return html + fmt::format("</main><script>{}</script></body></html>\n", kOverviewScript);
}

std::vector<OverviewEntry> write_overview(const fs::path& folder) {
  std::vector<OverviewEntry> entries = gather_overview(folder);
  if (entries.empty()) {
    throw Error("{}: holds no case; give the folder of the *.sog files", folder.string());
  }
  const fs::path pages = folder / "overview";
  create_folder(pages);
  for (const OverviewEntry& entry : entries) {
    write_picture(pages / (entry.name + ".webp"), entry.thumbnail);
  }
  write_text(pages / "index.html", overview_page(entries));
  return entries;
}

}  // namespace clipgs
