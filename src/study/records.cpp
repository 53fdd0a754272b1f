#include "study/records.h"

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

#include "study/delimited_text.h"

namespace clipgs {

namespace {

using json = StudyRecord;

constexpr size_t kMostLine = size_t{16} << 10;
constexpr size_t kMostComment = 4000;
constexpr size_t kMostModes = 8;
constexpr int kMostParticipant = 9999;
constexpr int kMostCount = 100'000'000;
constexpr double kMostNumber = 1e9;

using Check = std::function<bool(const json&)>;

struct Field {
  const char* key;
  Check is_right;
  const char* expected;
};

struct Kind {
  const char* name;
  std::vector<Field> fields;
};

bool is_integer_in(const json& value, int low, int high) {
  return value.is_number_integer() && value.get<double>() >= low && value.get<double>() <= high;
}

bool is_name(const json& value) {
  return value.is_string() && is_study_name(value.get_ref<const std::string&>());
}

Field integer(const char* key, int low, int high, const char* expected) {
  return {key, [=](const json& value) { return is_integer_in(value, low, high); }, expected};
}

Field name(const char* key) { return {key, is_name, "a name of letters, digits and strokes"}; }

Field one_of(const char* key, std::vector<std::string> texts, const char* expected) {
  return {key,
          [texts = std::move(texts)](const json& value) {
            return value.is_string() &&
                   std::ranges::find(texts, value.get<std::string>()) != texts.end();
          },
          expected};
}

bool is_measure(const json& value) {
  return value.is_number() && value.get<double>() >= 0 && value.get<double>() <= kMostNumber;
}

Field measure(const char* key) { return {key, is_measure, "a number, not below 0"}; }

Field optional_measure(const char* key) {
  return {key, [](const json& value) { return value.is_null() || is_measure(value); },
          "null or a number, not below 0"};
}

Field count(const char* key) { return integer(key, 0, kMostCount, "a whole number, not below 0"); }

bool is_order(const json& value) {
  return value.is_array() && !value.empty() && value.size() <= kMostModes &&
         std::ranges::all_of(value, is_name);
}

bool is_text(const json& value) {
  return value.is_string() && value.get_ref<const std::string&>().size() <= kMostComment;
}

bool are_answers(const json& value) {
  return value.is_array() && std::ranges::all_of(value, [](const json& answer) {
           return is_integer_in(answer, 0, 100);
         });
}

/// What a questionnaire asks: so many answers from `low` to `high`.
struct Questionnaire {
  const char* name;
  size_t count;
  int low;
  int high;
};
constexpr std::array kQuestionnaires = {Questionnaire{"sus", 10, 1, 5},
                                        Questionnaire{"efficiency", 1, 1, 5},
                                        Questionnaire{"tlx", 6, 0, 100}};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"session",
       {integer("format", 1, 1, "1; a newer clipgs wrote this"),
        name("plan"),
        name("digest"),
        integer("participant", 1, kMostParticipant, "a whole number from 1 to 9999"),
        {"order", is_order, "a list of modes"},
        one_of("device", {"headset", "desk"}, "headset or desk")}},
      {"task",
       {name("mode"),
        name("task"),
        {"practice", [](const json& value) { return value.is_boolean(); }, "true or false"},
        one_of("outcome", {"done", "time"}, "done or time"),
        measure("seconds"),
        measure("travel_mm"),
        measure("rotation_deg"),
        optional_measure("head_mm"),
        optional_measure("head_deg"),
        optional_measure("angle_deg"),
        optional_measure("distance_mm"),
        count("regrasps"),
        count("restarts"),
        count("frames"),
        optional_measure("frame_ms"),
        optional_measure("low_fps"),
        optional_measure("dropped"),
        optional_measure("display_hz")}},
      {"answers",
       {name("mode"),
        one_of("questionnaire", {"sus", "efficiency", "tlx"}, "sus, efficiency or tlx"),
        {"answers", are_answers, "a list of whole numbers"}}},
      {"comment", {{"text", is_text, "a text of at most 4000 bytes"}}},
      {"end", {}},
  };
  return all;
}

/// Columns of a row, after seq and kind; fields of the same name share one.
const std::vector<std::string>& columns() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> result = {"seq", "kind"};
    for (const Kind& kind : kinds()) {
      for (const Field& field : kind.fields) {
        if (std::ranges::find(result, field.key) == result.end()) {
          result.emplace_back(field.key);
        }
      }
    }
    return result;
  }();
  return all;
}

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw RefusedRecord("{}: {}", name, what);
}

void check_answers(const json& record, const std::string& name) {
  const auto* const form = std::ranges::find(
      kQuestionnaires, record["questionnaire"].get<std::string>(), &Questionnaire::name);
  const json& answers = record["answers"];
  if (answers.size() != form->count || !std::ranges::all_of(answers, [&](const json& answer) {
        return is_integer_in(answer, form->low, form->high);
      })) {
    refuse(name, fmt::format("{} has {} answers from {} to {}", form->name, form->count, form->low,
                             form->high));
  }
}

std::string cell(const json& value) {
  if (value.is_array()) {
    std::string list;
    for (const json& one : value) {
      list += list.empty() ? "" : " ";
      list += cell(one);
    }
    return list;
  }
  return value.is_null()
             ? ""
             : delimited_cell(value.is_string() ? value.get<std::string>() : value.dump(), ',');
}

}  // namespace

bool is_study_name(std::string_view text) {
  constexpr size_t kMost = 64;
  return !text.empty() && text.size() <= kMost &&
         text.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_") ==
             std::string_view::npos;
}

StudyRecord parse_record(std::string_view line, const std::string& name) {
  if (line.size() > kMostLine) {
    refuse(name, "the record is too long");
  }
  const json given = json::parse(line, nullptr, false);
  if (!given.is_object() || !given.contains("seq") || !given.contains("kind") ||
      !is_integer_in(given["seq"], 0, kMostCount) || !given["kind"].is_string()) {
    refuse(name, R"(this is no record: a line of JSON with "seq" and "kind" was expected)");
  }
  const std::string kind_name = given["kind"];
  const auto kind = std::ranges::find(kinds(), kind_name,
                                      [](const Kind& one) { return std::string_view(one.name); });
  if (kind == kinds().end()) {
    refuse(name, "\"kind\" should be session, task, answers, comment or end");
  }
  json record = {{"seq", given["seq"]}, {"kind", kind_name}};
  for (const Field& field : kind->fields) {
    if (!given.contains(field.key) || !field.is_right(given[field.key])) {
      refuse(name, fmt::format("\"{}\" of {} should be {}", field.key, kind_name, field.expected));
    }
    record[field.key] = given[field.key];
  }
  for (const auto& [key, value] : given.items()) {
    if (!record.contains(key)) {
      refuse(name, fmt::format("{} has no \"{}\": what is not asked for is not recorded", kind_name,
                               key));
    }
  }
  if ((kind_name == "session") != (record["seq"] == 0)) {
    refuse(name, "a session begins with its record \"session\", of which there is one");
  }
  if (kind_name == "answers") {
    check_answers(record, name);
  }
  return record;
}

std::string csv_header_of_records() {
  std::string header;
  for (const std::string& column : columns()) {
    header += (header.empty() ? "" : ",") + column;
  }
  return header;
}

std::string csv_of_record(const StudyRecord& record) {
  std::string row;
  for (const std::string& column : columns()) {
    row += &column == &columns().front() ? "" : ",";
    row += record.contains(column) ? cell(record[column]) : "";
  }
  return row;
}

}  // namespace clipgs
