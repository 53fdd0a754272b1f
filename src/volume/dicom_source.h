#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace clipgs {

class DicomArchive;

/// Where the bytes of one DICOM file lie: in a file of their own, packed by gzip or not, or in an
/// archive.
struct DicomSource {
  std::filesystem::path path;                   ///< of the file, or of the archive
  std::shared_ptr<const DicomArchive> archive;  ///< null: a file of its own
  size_t member = 0;                            ///< index into the archive's DICOM files

  /// What messages call it. Files in archives are counted, not named: names of folders and files in
  /// what a hospital hands out tell who the patient is.
  std::string name() const;
  /// What lies in one folder is exported together. For comparing only.
  std::filesystem::path folder() const;
  /// The whole file, unpacked. Throws Error, also if it was damaged since it was packed or unpacks
  /// to more than most_unpacked().
  std::vector<std::uint8_t> read() const;

  bool operator==(const DicomSource&) const = default;
};

/// True if the file starts like DICOM ("DICM" at byte 128), packed by gzip or not.
bool is_dicom_file(const std::filesystem::path& path);

/// The DICOM files right in the folder (`below`: and in its subfolders), in the order of their
/// paths; other files, and the DICOMDIR, are passed over. Throws Error if a folder cannot be
/// listed.
std::vector<DicomSource> dicom_files_in(const std::filesystem::path& folder, bool below);

/// True if the file starts like a ZIP.
bool is_zip_file(const std::filesystem::path& path);

/// The DICOM files of a ZIP, in all its folders. Throws Error (see DicomArchive).
std::vector<DicomSource> dicom_files_in_zip(const std::filesystem::path& path);

}  // namespace clipgs
