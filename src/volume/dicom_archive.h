#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "volume/nameless_file.h"

namespace clipgs {

/// The most bytes that may come out of packed DICOM files of that size: 16 MiB and a hundred times
/// as many, at most 64 GiB. Stated sizes are not believed.
std::uint64_t most_unpacked(std::uint64_t packed);

/// So many first bytes of a file, or all, show whether it is DICOM.
constexpr size_t kDicomHead = 4096;

/// True if these first bytes of a file, packed by gzip or not, are those of DICOM.
bool begins_dicom(std::span<const std::uint8_t> head);

/// The DICOM files of a ZIP, as hospitals hand out: nested folders, a DICOMDIR and viewers beside
/// them. They are unpacked into a file without a name, so that each can be read when it is needed
/// and nothing stays behind; what is no DICOM is not unpacked beyond its head.
class DicomArchive {
 public:
  /// Throws Error for what is no ZIP or truncated, needs a password, or unpacks to more than
  /// most_unpacked(), of one file to more than 4 GiB.
  explicit DicomArchive(const std::filesystem::path& path);

  size_t size() const { return members_.size(); }
  /// Counts all files of the archive from 1.
  size_t number_of(size_t member) const { return members_[member].number; }
  const std::string& folder_of(size_t member) const { return members_[member].folder; }
  /// Throws Error if the archive's checksum does not hold; `name` is what it calls the file.
  std::vector<std::uint8_t> read(size_t member, const std::string& name) const;

 private:
  struct Member {
    size_t number = 0;
    std::string folder;
    std::uint64_t offset = 0;
    size_t size = 0;
    bool damaged = false;
  };
  class Reader;

  std::vector<Member> members_;
  NamelessFile unpacked_;
};

}  // namespace clipgs
