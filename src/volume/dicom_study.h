#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "volume/dicom_series.h"

namespace clipgs {

/// All that there is to choose from where a DICOM folder, a ZIP of it, or one file was given.
struct DicomStudy {
  std::string where;                        ///< what messages call it
  std::vector<DicomStack> stacks;           ///< at least one, the largest first
  std::vector<UnreadableDicom> unreadable;  ///< files
  std::optional<size_t> given;              ///< the stack that the file given belongs to
};

/// True for folders, ZIPs and DICOM files.
bool is_dicom(const std::filesystem::path& path);

/// Looks through a folder and its subfolders, or a ZIP; of one file, through its own folder for its
/// own series. Throws Error if there is no image with a position, or the file given cannot be read.
DicomStudy open_study(const std::filesystem::path& path);

/// The index of the stack with this number (from 1) or series UID (of several phases the first,
/// with a warning that lists them); empty: of the one that the file given belongs to, or else the
/// first, with a warning that lists the others. Files that cannot be read are an Error if they
/// belong to the stack or, of unknown series, lie beside it; else a warning.
size_t choose_stack(const DicomStudy& study, const std::string& series);

}  // namespace clipgs
