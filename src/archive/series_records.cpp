#include "archive/series_records.h"

#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <random>
#include <string_view>
#include <utility>

#include "core/digest.h"
#include "core/error.h"
#include "core/file.h"
#include "core/json_reader.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kSecretFile = "secret";
constexpr const char* kImages = "images";
constexpr int kMostTries = 1'000'000;
constexpr size_t kDigestText = 64;
constexpr size_t kMostReason = 1000;

constexpr std::array<std::pair<SeriesStage, std::string_view>, 4> kStages = {
    {{SeriesStage::kBuild, "build"},
     {SeriesStage::kPutBack, "put back"},
     {SeriesStage::kDone, "done"},
     {SeriesStage::kFailed, "failed"}}};

/// Made once, of the system's randomness.
std::string secret_of(const fs::path& file) {
  if (!fs::exists(file)) {
    std::random_device random;
    Digest digest;
    for (int i = 0; i < 8; ++i) {
      digest.add(random());
    }
    write_text(file, digest.hex());
  }
  return read_text(file);
}

SeriesStage stage_of(const JsonReader& reader) {
  const std::string text = reader.text("stage");
  for (const auto& [stage, name] : kStages) {
    if (text == name) {
      return stage;
    }
  }
  reader.fail("stage");
}

SeriesRecord record_of(const json& object, const std::string& name) {
  const JsonReader reader(object, name);
  SeriesRecord record;
  record.stage = stage_of(reader);
  record.rule = reader.text("rule");
  record.listing = reader.text("listing", kDigestText);
  record.content = reader.text("content", kDigestText);
  record.tries = reader.integer("tries", 0, kMostTries);
  record.next_try = object.value("next_try", json(0)).get<std::int64_t>();
  record.reason = reader.has("reason") ? reader.text("reason", kMostReason) : "";
  return record;
}

bool is_record(const fs::path& path) { return path.extension() == ".json"; }

}  // namespace

SeriesRecords::SeriesRecords(const fs::path& folder)
    : lock_(folder, "give this one its own folder with --state") {
  fs::permissions(folder, fs::perms::owner_all);
  secret_ = secret_of(folder / kSecretFile);
  sweep();
}

/// What a process left that was killed: a patient's images, and the work of what was finished.
void SeriesRecords::sweep() const {
  for (const auto& entry : fs::directory_iterator(folder())) {
    if (!entry.is_directory()) {
      continue;
    }
    const std::optional<SeriesRecord> record = read(entry.path().filename().string());
    const bool over = record && record->settles(record->listing);
    fs::remove_all(over ? entry.path() : entry.path() / kImages);
  }
}

std::string SeriesRecords::name_of(const std::string& series) const {
  constexpr size_t kLength = 16;
  return Digest().add(secret_).add(series).add(secret_).hex().substr(0, kLength);
}

fs::path SeriesRecords::image_folder(const std::string& name) const {
  return work_folder(name) / kImages;
}

std::optional<SeriesRecord> SeriesRecords::read(const std::string& name) const {
  const fs::path file = folder() / (name + ".json");
  if (!fs::exists(file)) {
    return std::nullopt;
  }
  try {
    return record_of(json::parse(read_text(file)), file.string());
  } catch (const std::exception& error) {
    warn(fmt::format("{}: cannot be read ({}); the series is built again", file.string(),
                     error.what()));
    return std::nullopt;
  }
}

void SeriesRecords::write(const std::string& name, const SeriesRecord& record) const {
  std::string_view stage;
  for (const auto& [one, text] : kStages) {
    stage = one == record.stage ? text : stage;
  }
  nlohmann::ordered_json object = {{"stage", stage},
                                   {"rule", record.rule},
                                   {"listing", record.listing},
                                   {"content", record.content},
                                   {"tries", record.tries},
                                   {"next_try", record.next_try}};
  if (!record.reason.empty()) {
    object["reason"] = record.reason.substr(0, kMostReason);
  }
  constexpr auto kReplace = json::error_handler_t::replace;  // a reason that was cut in a letter
  write_text(folder() / (name + ".json"), object.dump(2, ' ', false, kReplace) + "\n");
}

void SeriesRecords::forget_failures() const {
  for (const auto& entry : fs::directory_iterator(folder())) {
    const std::string name = entry.path().stem().string();
    if (is_record(entry.path())) {
      if (const auto record = read(name); record && record->stage == SeriesStage::kFailed) {
        fs::remove(entry.path());
      }
    }
  }
}

}  // namespace clipgs
