#include "volume/dicom_source.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/file.h"
#include "volume/dicom_archive.h"
#include "volume/inflater.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::uint8_t>;

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

/// As much as kDicomHead, less if the file is shorter.
Bytes head_of(std::ifstream file) {
  Bytes head(kDicomHead);
  file.read(reinterpret_cast<char*>(head.data()), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return head;
}

/// Whether reading it would say that it is DICOM, or that something is wrong with it: what cannot
/// be opened, or is an empty shell, is missed when it is read, not passed over.
bool may_be_dicom(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    return true;
  }
  const Bytes head = head_of(std::move(file));
  return begins_dicom(head) || (head.empty() && path.extension() == ".dcm");
}

/// A gzip file's content. Its stated size is not believed: memory grows with what comes out.
Bytes unpacked(const Bytes& packed, const std::string& name) {
  std::istringstream stream(std::string(packed.begin(), packed.end()));
  Inflater inflater(stream);
  Bytes bytes;
  while (inflater.state() == Inflater::State::kGoing) {
    constexpr size_t kPiece = size_t{1} << 20;
    const size_t done = bytes.size();
    if (done > most_unpacked(packed.size())) {
      throw Error(
          "{}: unpacks to more than DICOM does ({} MiB and no end); unpack it if you trust it",
          name, done >> 20);
    }
    bytes.resize(done + kPiece);
    bytes.resize(done + inflater.read(std::span(bytes).subspan(done)));
  }
  if (inflater.state() != Inflater::State::kWhole) {
    throw Error("{}: truncated or corrupt: gzip gets {} bytes out of it and then {}", name,
                bytes.size(),
                inflater.state() == Inflater::State::kCutOff     ? "the file ends"
                : inflater.state() == Inflater::State::kMismatch ? "its checksum is wrong"
                                                                 : "what makes no sense");
  }
  return bytes;
}

}  // namespace

std::string DicomSource::name() const {
  return archive == nullptr
             ? path.string()
             : fmt::format("{} (its file {})", path.string(), archive->number_of(member));
}

fs::path DicomSource::folder() const {
  return archive == nullptr ? path.parent_path() : path / archive->folder_of(member);
}

Bytes DicomSource::read() const {
  Bytes bytes = archive == nullptr ? read_file(path) : archive->read(member, name());
  return begins_gzip(bytes) ? unpacked(bytes, name()) : bytes;
}

bool is_dicom_file(const fs::path& path) {
  return begins_dicom(head_of(std::ifstream(path, std::ios::binary)));
}

std::vector<DicomSource> dicom_files_in(const fs::path& folder, bool below) {
  std::vector<DicomSource> sources;
  for (const fs::path& file : below ? files_of<fs::recursive_directory_iterator>(folder)
                                    : files_of<fs::directory_iterator>(folder)) {
    if (file.filename() != "DICOMDIR" && may_be_dicom(file)) {
      sources.push_back({file, nullptr, 0});
    }
  }
  return sources;
}

bool is_zip_file(const fs::path& path) {
  const Bytes head = head_of(std::ifstream(path, std::ios::binary));
  const auto begins = [&](std::string_view magic) {
    return head.size() >= magic.size() &&
           std::ranges::equal(std::span(head).first(magic.size()), magic);
  };
  return begins("PK\3\4") || begins("PK\5\6");
}

std::vector<DicomSource> dicom_files_in_zip(const fs::path& path) {
  const auto archive = std::make_shared<const DicomArchive>(path);
  std::vector<DicomSource> sources;
  sources.reserve(archive->size());
  for (size_t i = 0; i < archive->size(); ++i) {
    sources.push_back({path, archive, i});
  }
  return sources;
}

}  // namespace clipgs
