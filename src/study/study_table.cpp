#include "study/study_table.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <tuple>

#include "core/error.h"
#include "study/delimited_text.h"

namespace clipgs {

namespace {

struct KnownMeasure {
  std::string_view name;
  const char* title;
  const char* unit;
};
constexpr std::array kKnownMeasures{
    KnownMeasure{"sus", "SUS", "0 to 100"},
    KnownMeasure{"efficiency", "Efficiency", "1 to 5"},
    KnownMeasure{"tlx", "Raw NASA-TLX", "0 to 100"},
    KnownMeasure{"seconds", "Task time", "s"},
    KnownMeasure{"travel_mm", "Plane travel", "mm"},
    KnownMeasure{"rotation_deg", "Plane rotation", "°"},
    KnownMeasure{"head_mm", "Head travel", "mm"},
    KnownMeasure{"head_deg", "Head rotation", "°"},
    KnownMeasure{"angle_deg", "Angle error", "°"},
    KnownMeasure{"distance_mm", "Distance error", "mm"},
    KnownMeasure{"regrasps", "Regrasps", ""},
    KnownMeasure{"frame_ms", "Frame time", "ms"},
};

auto known_measure(const std::string& name) {
  return std::ranges::find(kKnownMeasures, name, &KnownMeasure::name);
}

/// A questionnaire whose answers are columns of their own.
struct AnswerColumns {
  const char* measure;
  const char* prefix;
  size_t count;
};
constexpr std::array kAnswerColumns{AnswerColumns{"sus", "q", 10}, AnswerColumns{"tlx", "tlx", 6}};

/// Whether the answers can stand for the measure: no row has a value of it alone.
bool has_answers(const StudyTable& table, const std::string& measure) {
  return std::ranges::all_of(table.rows, [&](const StudyRow& row) {
    return !row.values.contains(measure) || row.answers.contains(measure);
  });
}

/// The columns of one measure: what the header calls them, and a row's cells.
struct CsvColumns {
  std::vector<std::string> names;
  std::string measure;
  bool answers = false;
};

std::vector<CsvColumns> csv_columns(const StudyTable& table) {
  std::vector<CsvColumns> result;
  for (const std::string& measure : table.measures) {
    CsvColumns columns{{}, measure, false};
    const auto* const known = std::ranges::find(kAnswerColumns, measure, &AnswerColumns::measure);
    if (known != kAnswerColumns.end() && has_answers(table, measure)) {
      columns.answers = true;
      for (size_t i = 1; i <= known->count; ++i) {
        columns.names.push_back(fmt::format("{}{}", known->prefix, i));
      }
    } else {
      columns.names.push_back(measure);
    }
    result.push_back(std::move(columns));
  }
  return result;
}

std::string csv_cells(const StudyRow& row, const CsvColumns& columns) {
  std::string cells;
  const auto answers = row.answers.find(columns.measure);
  const auto value = row.values.find(columns.measure);
  for (size_t i = 0; i < columns.names.size(); ++i) {
    cells += ',';
    if (columns.answers && answers != row.answers.end()) {
      cells += fmt::format("{}", answers->second[i]);
    } else if (!columns.answers && value != row.values.end()) {
      cells += fmt::format("{}", value->second);
    }
  }
  return cells;
}

}  // namespace

MeasureTitle measure_title(const std::string& measure) {
  const auto* const known = known_measure(measure);
  return known == kKnownMeasures.end() ? MeasureTitle{measure, ""}
                                       : MeasureTitle{known->title, known->unit};
}

bool measure_order(const std::string& a, const std::string& b) {
  return std::tuple(known_measure(a), a) < std::tuple(known_measure(b), b);
}

bool participant_order(const std::string& a, const std::string& b) {
  const auto key = [](const std::string& text) {
    const bool name = !std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
    return std::tuple(name, name ? 0 : text.size(), text);
  };
  return key(a) < key(b);
}

void join(StudyTable& table, StudyTable other) {
  std::map<std::pair<std::string, std::string>, std::string> places;
  for (const StudyRow& row : table.rows) {
    places.emplace(std::pair(row.participant, row.mode), row.place);
  }
  for (StudyRow& row : other.rows) {
    const auto [first, is_new] = places.emplace(std::pair(row.participant, row.mode), row.place);
    if (!is_new) {
      throw Error("{}: participant {} has answers in mode {} already, at {}; keep one of them",
                  row.place, row.participant, row.mode, first->second);
    }
    table.rows.push_back(std::move(row));
  }
  table.measures.insert(table.measures.end(), other.measures.begin(), other.measures.end());
  std::ranges::sort(table.measures, measure_order);
  const auto doubled = std::ranges::unique(table.measures);
  table.measures.erase(doubled.begin(), doubled.end());
  table.remarks.insert(table.remarks.end(), other.remarks.begin(), other.remarks.end());
}

std::string study_csv(const StudyTable& table) {
  const std::vector<CsvColumns> columns = csv_columns(table);
  std::string text = "participant,mode";
  for (const CsvColumns& one : columns) {
    for (const std::string& name : one.names) {
      text += ',' + delimited_cell(name, ',');
    }
  }
  text += '\n';
  std::vector<const StudyRow*> rows;
  rows.reserve(table.rows.size());
  for (const StudyRow& row : table.rows) {
    rows.push_back(&row);
  }
  std::ranges::sort(rows, [](const StudyRow* a, const StudyRow* b) {
    return a->participant != b->participant ? participant_order(a->participant, b->participant)
                                            : a->mode < b->mode;
  });
  for (const StudyRow* row : rows) {
    text += delimited_cell(row->participant, ',') + ',' + delimited_cell(row->mode, ',');
    for (const CsvColumns& one : columns) {
      text += csv_cells(*row, one);
    }
    text += '\n';
  }
  return text;
}

}  // namespace clipgs
