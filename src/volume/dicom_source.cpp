#include "volume/dicom_source.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

constexpr size_t kPreamble = 128;

template <typename Iterator>
std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (Iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code unknown;  // a dangling link is no file
    if (it->is_regular_file(unknown)) {
      files.push_back(it->path());
    }
  }
  if (error) {
    throw Error("{}: cannot be listed: {}", folder.string(), error.message());
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

std::vector<std::uint8_t> DicomSource::read() const { return read_file(path); }

bool is_dicom_file(const fs::path& path) {
  std::array<char, kPreamble + 4> head{};
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), head.size());
  return file && std::memcmp(&head[kPreamble], "DICM", 4) == 0;
}

std::vector<DicomSource> dicom_files_in(const fs::path& folder, bool below) {
  std::vector<DicomSource> sources;
  for (fs::path& file : below ? files_of<fs::recursive_directory_iterator>(folder)
                              : files_of<fs::directory_iterator>(folder)) {
    if (is_dicom_file(file)) {
      sources.push_back({std::move(file)});
    }
  }
  return sources;
}

}  // namespace clipgs
