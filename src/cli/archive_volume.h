#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "archive/dicomweb.h"
#include "archive/fetch.h"

#include "cli/archive_options.h"
#include "core/private_folder.h"
#include "volume/load.h"

namespace clipgs {

/// What came of an address.
struct FetchedStudy {
  std::vector<ArchiveSeries> series;  ///< that there was to choose from; one is taken
  Fetched fetched;
};

/// Fetches a series into a folder: of an address of a study the one that `wanted` names, by its
/// number or UID, or the largest. Throws Error.
FetchedStudy fetch_study(const DicomWebAddress& address, const std::string& wanted,
                         const ArchiveArguments& archive, const std::filesystem::path& folder);

/// A volume as it is given on a command line: a path, or an address in an archive, of which the
/// files lie in a private folder as long as this lives. No name and no UID of the archive is in the
/// folder's name.
class GivenVolume {
 public:
  /// Fetches. `loading`: --series chooses in the archive where the address is a study's, and then
  /// no more in the folder. Throws Error.
  GivenVolume(std::string given, LoadOptions& loading, const ArchiveArguments& archive);

  const std::string& path() const { return path_; }
  /// Removes what was fetched, once it has been read.
  void forget() { folder_.reset(); }

 private:
  std::string path_;
  std::optional<PrivateFolder> folder_;
};

}  // namespace clipgs
