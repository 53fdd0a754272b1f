#pragma once

#include <cstdint>
#include <filesystem>

#include "archive/dicomweb.h"

namespace clipgs {

/// What was fetched.
struct Fetched {
  size_t files = 0;
  std::uint64_t bytes = 0;
};

/// Fetches the files of a series into `folder`, which must not be there, or be empty. They are
/// counted, 000001.dcm, …, and nothing of what the archive calls them is in their names. Until all
/// are there they lie in FOLDER.clipgs-part, which a later call goes on from; both can be read by
/// their owner alone (0700). What comes is checked: each file is DICOM, of this series, and all are
/// of one patient; what did not come, or came to the archive meanwhile, is asked for by itself.
/// Throws Error, also if another process fetches into the folder, and if there is still not what
/// the archive says that there is.
Fetched fetch_series(DicomWebStudy& study, const std::string& series,
                     const std::filesystem::path& folder);

}  // namespace clipgs
