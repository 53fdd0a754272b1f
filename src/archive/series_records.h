#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/lock.h"

namespace clipgs {

/// What a series is waiting for.
enum class SeriesStage : std::uint8_t {
  kBuild,
  kPutBack,  ///< there is its case
  kDone,
  kFailed,  ///< too often: it is left alone
};

/// What is known of a series; nothing of the patient.
struct SeriesRecord {
  SeriesStage stage = SeriesStage::kBuild;
  std::string rule;           ///< name
  std::string listing;        ///< digest of what the archive lists of its images
  std::string content{};      ///< digest of the images; "": not fetched yet
  int tries = 0;              ///< of the stage, that were begun
  std::int64_t next_try = 0;  ///< s since 1970
  std::string reason{};       ///< of the last failure, one line

  /// Whether there is nothing more to do for images that are listed so.
  bool settles(const std::string& now_listed) const {
    return listing == now_listed && (stage == SeriesStage::kDone || stage == SeriesStage::kFailed);
  }
};

/// A folder with the records of series, NAME.json each, and of a series that is worked at a folder
/// NAME. One process at a time works here. Nobody but the owner may open it.
class SeriesRecords {
 public:
  /// Throws Error if another process has the folder, or it cannot be written. Removes images that a
  /// killed process left.
  explicit SeriesRecords(const std::filesystem::path& folder);

  /// What a series is called here and in the folder of cases: 16 hexadecimal digits that follow
  /// from a secret of this folder, and that nobody else can tell the series from.
  std::string name_of(const std::string& series) const;

  /// Nothing: there is none, or it cannot be read, which is said.
  std::optional<SeriesRecord> read(const std::string& name) const;
  /// Throws Error.
  void write(const std::string& name, const SeriesRecord& record) const;
  /// Of those that failed, which will be tried again then.
  void forget_failures() const;

  const std::filesystem::path& folder() const { return lock_.folder(); }
  std::filesystem::path work_folder(const std::string& name) const { return folder() / name; }
  std::filesystem::path image_folder(const std::string& name) const;

 private:
  void sweep() const;

  FolderLock lock_;
  std::string secret_;
};

}  // namespace clipgs
