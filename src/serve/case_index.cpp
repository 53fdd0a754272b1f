#include "serve/case_index.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "core/error.h"
#include "core/file.h"
#include "core/percent.h"
#include "serve/http.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr const char* kExtension = ".sog";
constexpr const char* kWorkFolder = ".clipgs-work";

/// Without its path: browsers read it.
[[noreturn]] void fail_folder(const std::error_code& error) {
  throw Error(
      "the folder of the cases cannot be read ({}); put it back, or end clipgs serve and "
      "give it another",
      error.message());
}

std::shared_ptr<const CaseEntry> read_entry(const std::string& name, const fs::path& path,
                                            const fs::path& folder) {
  auto entry = std::make_shared<CaseEntry>();
  entry->name = name;
  try {
    const OpenFile file(path, folder);
    entry->version = file.state().version;
    entry->bytes = file.state().size;
    // Errors name the file, not where it lies: browsers read them.
    entry->info = read_case_summary(
        {file.state().size,
         [&](std::uint64_t offset, std::span<std::uint8_t> out) { return file.read(offset, out); }},
        path.filename().string());
  } catch (const Error& error) {
    entry->error = error.what();
  }
  return entry;
}

/// Whether cases are looked for in a folder of that name.
bool is_looked_into(const fs::path& name) {
  return !name.string().starts_with('.') && name.extension() != kWorkFolder;
}

/// "a/b c" as part of an address, which keeps its strokes: proxies do not like them written else.
std::string encode_path(const std::string& name) {
  std::string address;
  for (const fs::path& part : fs::path(name)) {
    address += (address.empty() ? "" : "/") + percent_encode(part.string());
  }
  return address;
}

}  // namespace

CaseIndex::CaseIndex(fs::path folder, std::set<std::string> only, bool subfolders)
    : folder_(std::move(folder)), only_(std::move(only)), subfolders_(subfolders) {
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
  // Wherever the program goes, it is the same one.
  folder_ = fs::absolute(folder_);
}

void CaseIndex::require_folder() const {
  std::error_code error;
  const fs::directory_iterator readable(real_folder(), error);
  if (error) {
    fail_folder(error);
  }
}

void CaseIndex::collect(const fs::path& root, const std::string& prefix, Found& found,
                        std::error_code& error) {
  for (auto it = fs::directory_iterator(root / prefix, error);
       !error && it != fs::directory_iterator(); it.increment(error)) {
    const fs::path file = it->path().filename();
    std::error_code ignored;
    if (subfolders_ && !it->is_symlink(ignored) && it->is_directory(ignored)) {
      std::error_code gone;  // only those of that folder are
      if (is_looked_into(file) && std::ranges::count(prefix, '/') < kMostFolders) {
        collect(root, prefix + file.string() + "/", found, gone);
      }
      continue;
    }
    const std::string name = prefix + file.stem().string();
    if (file.extension() != kExtension || is_hidden(name)) {
      continue;
    }
    if (auto entry = look_at(name, root)) {
      found.emplace(name, std::move(entry));
    }
  }
}

CaseEntries CaseIndex::list() {
  const fs::path folder = real_folder();
  Found now;
  std::error_code error;
  collect(folder, "", now, error);
  if (error) {
    fail_folder(error);
  }
  CaseEntries result;
  result.reserve(now.size());
  for (const auto& [name, entry] : now) {
    result.push_back(entry);
  }
  const std::scoped_lock lock(mutex_);
  entries_ = std::move(now);
  return result;
}

std::shared_ptr<const CaseEntry> CaseIndex::find(const std::string& name) {
  const fs::path folder = real_folder();
  if (!is_listed(name, folder)) {
    return nullptr;
  }
  auto entry = look_at(name, folder);
  const std::scoped_lock lock(mutex_);
  if (entry) {
    entries_[name] = entry;
  } else {
    entries_.erase(name);
  }
  return entry;
}

std::shared_ptr<const OpenFile> CaseIndex::open(const CaseEntry& entry) const {
  const fs::path folder = real_folder();
  return std::make_shared<OpenFile>(folder / (entry.name + kExtension), folder);
}

bool CaseIndex::is_listed(const std::string& name, const fs::path& folder) const {
  if (is_hidden(name) || name.find('\0') != std::string::npos || name.starts_with('/') ||
      fs::path(name + kExtension).extension() != kExtension) {
    return false;
  }
  const fs::path parents = fs::path(name).parent_path();
  if (parents.empty()) {
    return true;
  }
  // Written in one way alone, and no deeper than list() goes.
  if (!subfolders_ || std::distance(parents.begin(), parents.end()) > kMostFolders ||
      (parents / fs::path(name).filename()).string() != name) {
    return false;
  }
  fs::path so_far = folder;
  return std::ranges::all_of(parents, [&](const fs::path& part) {
    so_far /= part;
    std::error_code error;
    return is_looked_into(part) && fs::is_directory(fs::symlink_status(so_far, error));
  });
}

fs::path CaseIndex::real_folder() const {
  std::error_code error;
  fs::path folder = fs::canonical(folder_, error);
  if (error) {
    fail_folder(error);
  }
  return folder;
}

std::shared_ptr<const CaseEntry> CaseIndex::look_at(const std::string& name,
                                                    const fs::path& folder) {
  const fs::path path = folder / (name + kExtension);
  const std::optional<FileState> state = file_state(path);
  if (!state) {
    return nullptr;
  }
  {
    const std::scoped_lock lock(mutex_);
    const auto known = entries_.find(name);
    if (known != entries_.end() && known->second->version == state->version) {
      return known->second;
    }
  }
  return read_entry(name, path, folder);
}

nlohmann::json case_index_json(const CaseEntries& entries) {
  nlohmann::json cases = nlohmann::json::array();
  for (const auto& entry : entries) {
    nlohmann::json one = {{"name", entry->name}, {"bytes", entry->bytes}};
    if (!entry->error.empty()) {
      one["error"] = entry->error;
    } else {
      const std::string address = "cases/" + encode_path(entry->name);
      // The version lets a browser keep a thumbnail for ever and still see a new one.
      const std::string thumbnail =
          fmt::format("{}/thumbnail?v={}", address, percent_encode(entry->version));
      one["version"] = entry->version;
      one["trained"] = entry->info.scene.trained;
      one["title"] = entry->info.scene.title;
      one["preset"] = entry->info.scene.preset;
      one["look"] = volume_look_json(entry->info.scene.look);
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
