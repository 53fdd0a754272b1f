#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace clipgs {

/// Where the bytes of one DICOM file lie.
struct DicomSource {
  std::filesystem::path path;

  /// What messages call it.
  std::string name() const { return path.string(); }
  /// What lies in one folder is exported together.
  std::filesystem::path folder() const { return path.parent_path(); }
  /// The whole file. Throws Error.
  std::vector<std::uint8_t> read() const;
};

/// True if the file starts like DICOM ("DICM" at byte 128).
bool is_dicom_file(const std::filesystem::path& path);

/// The DICOM files right in the folder (`below`: and in its subfolders), in the order of their
/// paths; other files are passed over. Throws Error if a folder cannot be listed.
std::vector<DicomSource> dicom_files_in(const std::filesystem::path& folder, bool below);

}  // namespace clipgs
