#include "measure/overview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>
#include <tuple>

#include "asset/case.h"
#include "core/body_part.h"
#include "core/error.h"
#include "core/file.h"
#include "measure/build_notes.h"
#include "measure/overview_figures.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// As the steps of a batch are called, in their order.
constexpr std::array kSteps = {"check", "needs",  "build", "dataset", "train",
                               "bake",  "refine", "pack",  "eval"};

/// Of a file that is not there, or is no JSON, nothing.
Json read_json(const fs::path& path) {
  constexpr std::uintmax_t kMost = 64 << 20;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    return {};
  }
  const std::vector<std::uint8_t> bytes = read_file(path, kMost);
  return Json::parse(bytes.begin(), bytes.end(), nullptr, false);
}

/// What stands there if it is a T and nothing otherwise.
template <typename T>
T value_of(const Json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if constexpr (std::is_same_v<T, std::string>) {
    return found != object.end() && found->is_string() ? found->get<std::string>() : "";
  } else {
    return found != object.end() && found->is_number() ? found->get<T>() : T{};
  }
}

void add_case(const fs::path& path, OverviewEntry& entry) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file) {
    return;
  }
  const ByteSource source{size, [&](std::uint64_t offset, std::span<std::uint8_t> out) {
                            file.clear();
                            file.seekg(static_cast<std::streamoff>(offset));
                            file.read(reinterpret_cast<char*>(out.data()),
                                      static_cast<std::streamsize>(out.size()));
                            return static_cast<size_t>(file.gcount());
                          }};
  try {
    CaseInfo info = read_case_summary(source, path.filename().string());
    entry.title = info.scene.title;
    entry.preset = info.scene.preset;
    entry.created = info.scene.created;
    entry.region = info.scene.look.part == BodyPart::kUnknown
                       ? std::string()
                       : body_part_name(info.scene.look.part);
    entry.thumbnail = std::move(info.thumbnail);
    figure(entry, Figure::kSplats) = static_cast<double>(info.splats);
    figure(entry, Figure::kBytes) = static_cast<double>(size);
  } catch (const Error& broken) {
    entry.state = OverviewEntry::State::kFailed;
    entry.failure = without_names(broken.what());
  }
}

void add_notes(const fs::path& log, OverviewEntry& entry) {
  constexpr std::uintmax_t kMost = 16 << 20;
  std::error_code error;
  if (fs::file_size(log, error) > kMost || error) {
    return;
  }
  for (const std::string& note : notes_of_log(read_text(log))) {
    if (std::ranges::find(entry.notes, note) == entry.notes.end()) {
      entry.notes.push_back(note);
    }
  }
}

/// What the steps of a batch noted; `last`: the one that all is done with, "" if nothing is known.
void add_records(const fs::path& folder, const std::string& last, OverviewEntry& entry) {
  const auto record_of = [&](const std::string& step) {
    return read_json(folder / fmt::format("{}.json", step));
  };
  const Json end = last.empty() ? Json() : record_of(last);
  const bool done = last.empty() || value_of<std::string>(end, "status") == "done";
  double seconds = 0;
  std::string failure;
  for (const char* const step : kSteps) {
    const Json record = record_of(step);
    seconds += value_of<double>(record, "seconds");
    // What failed before the end was reached is forgotten: steps whole once, and apart now.
    const bool counts =
        !done || value_of<std::string>(record, "began") >= value_of<std::string>(end, "began");
    if (counts && failure.empty() && value_of<std::string>(record, "status") == "failed") {
      failure =
          fmt::format("{}: {}", step, without_names(value_of<std::string>(record, "last_line")));
    }
    add_notes(folder / fmt::format("{}.log", step), entry);
  }
  if (seconds > 0) {
    figure(entry, Figure::kMinutes) = seconds / 60;
  }
  if (!failure.empty()) {
    entry.failure = failure;
    entry.state = OverviewEntry::State::kFailed;
  } else if (!done && entry.state != OverviewEntry::State::kFailed) {
    entry.state = OverviewEntry::State::kUnfinished;
  }
}

/// The cases that a batch was told to make, and the last step of each.
std::map<std::string, std::string> planned_cases(const fs::path& folder) {
  std::map<std::string, std::string> planned;
  const Json batch = read_json(folder / "batch.json");
  const auto cases = batch.is_object() ? batch.find("cases") : batch.end();
  if (cases != batch.end() && cases->is_array()) {
    for (const Json& one : *cases) {
      const auto name = value_of<std::string>(one, "name");
      if (!name.empty() && name.find('/') == std::string::npos) {
        planned[name] = value_of<std::string>(one, "last");
      }
    }
  }
  return planned;
}

std::map<std::string, std::string> all_cases(const fs::path& folder) {
  std::map<std::string, std::string> cases = planned_cases(folder);
  std::error_code error;
  for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator();
       it.increment(error)) {
    if (it->path().extension() == ".sog") {
      cases.emplace(it->path().stem().string(), "");
    }
  }
  if (error) {
    throw Error("{}: cannot be read ({}); give the folder of the cases", folder.string(),
                error.message());
  }
  return cases;
}

OverviewEntry read_entry(const fs::path& folder, const std::string& name, const std::string& last) {
  OverviewEntry entry;
  entry.name = name;
  add_case(folder / (name + ".sog"), entry);
  add_records(folder / (name + ".clipgs-work") / "batch", last, entry);
  const Json figures = read_json(folder / (name + ".figures"));
  add_measured(figures, entry);
  std::error_code error;
  entry.has_report = fs::exists(folder / "overview" / (name + ".html"), error);
  return entry;
}

}  // namespace

std::vector<OverviewEntry> gather_overview(const fs::path& folder) {
  std::vector<OverviewEntry> entries;
  for (const auto& [name, last] : all_cases(folder)) {
    entries.push_back(read_entry(folder, name, last));
  }
  say_what_stands_out(entries);
  std::ranges::stable_sort(entries, [](const OverviewEntry& a, const OverviewEntry& b) {
    return std::tuple(a.state, -a.score) < std::tuple(b.state, -b.score);
  });
  return entries;
}

}  // namespace clipgs
