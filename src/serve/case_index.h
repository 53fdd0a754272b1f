#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "asset/case.h"
#include "serve/open_file.h"

namespace clipgs {

/// One *.sog of the folder, at the moment it was looked at.
struct CaseEntry {
  /// The file's name without .sog, behind the folders below the served one: "cardiology/head".
  /// What addresses call the case.
  std::string name;
  std::string version;       ///< changes whenever the file does; empty of what may not be read
  std::uintmax_t bytes = 0;  ///< 0 of what may not be read
  CaseInfo info;             ///< empty where error is not
  std::string error;         ///< one line saying why this is no case, or empty
};

using CaseEntries = std::vector<std::shared_ptr<const CaseEntry>>;

/// The cases of one folder, and of those below it if that is wanted, by name. Files that come,
/// change or go are seen at the next call; one that could be opened and did not change is not read
/// again, and of the others only what read_case_summary() wants. Links to files are followed within
/// the folder alone, those to folders are not; nor are folders looked into whose name begins with a
/// dot, or in which clipgs build works. Safe to use from several threads, which do not wait for
/// each other while files are read.
class CaseIndex {
 public:
  static constexpr int kMostFolders = 8;  ///< one in the other, below the served one

  /// `only`: the names of those that there are for anybody to see, if not all. Throws Error if
  /// `folder` is not a folder that can be read.
  explicit CaseIndex(std::filesystem::path folder, std::set<std::string> only = {},
                     bool subfolders = false);

  /// Throws Error if the folder is no longer there.
  void require_folder() const;
  /// Every *.sog, sorted by name; broken ones with their error. Throws Error if the folder is no
  /// longer there; a folder below it that cannot be read has none.
  CaseEntries list();
  /// The case of that name, or null. Only what `list` gives can be found, whatever `name` holds.
  /// Throws Error if the folder is no longer there.
  std::shared_ptr<const CaseEntry> find(const std::string& name);
  /// The file of that case. Throws Error if it is gone, or leads out of the folder by now.
  std::shared_ptr<const OpenFile> open(const CaseEntry& entry) const;

 private:
  using Found = std::map<std::string, std::shared_ptr<const CaseEntry>>;

  std::filesystem::path real_folder() const;
  /// Adds the cases of the folder that `prefix` leads to ("", "a/b/"), and of those below it.
  void collect(const std::filesystem::path& root, const std::string& prefix, Found& found,
               std::error_code& error);
  /// Whether list() would look for that name, and in which folder.
  bool is_listed(const std::string& name, const std::filesystem::path& folder) const;
  /// The entry of that name if its file is still the same, read anew if not; null if it is none.
  std::shared_ptr<const CaseEntry> look_at(const std::string& name,
                                           const std::filesystem::path& folder);

  bool is_hidden(const std::string& name) const { return !only_.empty() && !only_.contains(name); }

  std::filesystem::path folder_;
  std::set<std::string> only_;
  bool subfolders_;
  std::mutex mutex_;  ///< of entries_; held for no longer than a look into them
  Found entries_;
};

/// {"cases": [{name, version, title, preset, look, created, bytes, splats, sh_degree, trained,
/// file, thumbnail}, …]}: `version` changes whenever the file does; `file` and `thumbnail` are
/// addresses, the latter null if there is none; `look` is volume_look_json()'s, with the region of
/// the body, `trained` Scene's; a broken case has name, bytes and error alone.
nlohmann::json case_index_json(const CaseEntries& entries);

}  // namespace clipgs
