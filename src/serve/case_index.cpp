#include "serve/case_index.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.h"
#include "core/file.h"
#include "serve/http.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr const char* kExtension = ".sog";

std::shared_ptr<const CaseEntry> read_entry(const fs::path& path, const FileState& state) {
  auto entry = std::make_shared<CaseEntry>();
  entry->name = path.stem().string();
  entry->path = path;
  entry->version = state.version;
  entry->bytes = state.size;
  try {
    // Errors name the file, not where it lies: browsers read them.
    entry->info = read_case_info(read_file(path), path.filename().string());
  } catch (const Error& error) {
    entry->error = error.what();
  }
  return entry;
}

}  // namespace

CaseIndex::CaseIndex(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  const fs::file_status status = fs::status(folder_, error);
  if (!fs::exists(status)) {
    throw Error("{}: there is no such folder; give the one that holds the cases", folder_.string());
  }
  if (!fs::is_directory(status)) {
    throw Error("{}: is a file; give the folder that holds the cases", folder_.string());
  }
  const fs::directory_iterator readable(folder_, error);
  if (error) {
    throw Error("{}: cannot be read ({}); check its permissions", folder_.string(),
                error.message());
  }
}

CaseEntries CaseIndex::list() {
  const std::scoped_lock lock(mutex_);
  std::map<std::string, std::shared_ptr<const CaseEntry>> now;
  std::error_code error;
  for (auto it = fs::directory_iterator(folder_, error); !error && it != fs::directory_iterator();
       it.increment(error)) {
    const fs::path& path = it->path();
    const std::optional<FileState> state = file_state(path);
    if (path.extension() != kExtension || !state) {
      continue;
    }
    const auto known = entries_.find(path.stem().string());
    const bool same = known != entries_.end() && known->second->version == state->version;
    now[path.stem().string()] = same ? known->second : read_entry(path, *state);
  }
  entries_ = std::move(now);
  CaseEntries result;
  result.reserve(entries_.size());
  for (const auto& [name, entry] : entries_) {
    result.push_back(entry);
  }
  return result;
}

std::shared_ptr<const CaseEntry> CaseIndex::find(const std::string& name) {
  for (const auto& entry : list()) {
    if (entry->name == name) {
      return entry;
    }
  }
  return nullptr;
}

nlohmann::json case_index_json(const CaseEntries& entries) {
  nlohmann::json cases = nlohmann::json::array();
  for (const auto& entry : entries) {
    nlohmann::json one = {{"name", entry->name}, {"bytes", entry->bytes}};
    if (!entry->error.empty()) {
      one["error"] = entry->error;
    } else {
      const std::string address = "cases/" + percent_encode(entry->name);
      // The version lets a browser keep a thumbnail for ever and still see a new one.
      const std::string thumbnail =
          fmt::format("{}/thumbnail?v={}", address, percent_encode(entry->version));
      one["title"] = entry->info.scene.title;
      one["preset"] = entry->info.scene.preset;
      one["created"] = entry->info.scene.created;
      one["splats"] = entry->info.splats;
      one["sh_degree"] = entry->info.sh_degree;
      one["file"] = address + kExtension;
      one["thumbnail"] =
          entry->info.thumbnail.empty() ? nlohmann::json() : nlohmann::json(thumbnail);
    }
    cases.push_back(std::move(one));
  }
  return {{"cases", std::move(cases)}};
}

}  // namespace clipgs
