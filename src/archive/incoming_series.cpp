#include "archive/incoming_series.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/file.h"
#include "volume/dicom_elements.h"
#include "volume/dicom_source.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr const char* kUnfinished = "incoming";  // the file that comes

fs::path numbered(const fs::path& folder, size_t number) {
  return folder / fmt::format("{:06}.dcm", number);
}

}  // namespace

IncomingSeries::IncomingSeries(fs::path folder, std::string series, std::string place)
    : folder_(std::move(folder)), series_(std::move(series)), place_(std::move(place)) {
  take_over();
}

IncomingSeries::~IncomingSeries() {
  close();
  std::error_code ignored;
  fs::remove(folder_ / kUnfinished, ignored);
}

/// After a power cut a file may have lost its content.
void IncomingSeries::take_over() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    if (entry.path().extension() == ".dcm") {
      files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  for (const fs::path& file : files) {
    try {
      check(file);
    } catch (const Error&) {
      fs::remove(file);
      continue;
    }
    fs::rename(file, numbered(folder_, ++number_));
  }
}

void IncomingSeries::close() {
  if (fd_ >= 0) {
    ::close(fd_);
  }
  fd_ = -1;
}

void IncomingSeries::begin() {
  close();
  const fs::path file = folder_ / kUnfinished;
  fd_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (fd_ < 0) {
    throw Error("{}: cannot be written ({}); choose a folder you can write to", folder_.string(),
                std::strerror(errno));
  }
  size_ = 0;
}

void IncomingSeries::receive(std::string_view bytes) {
  size_ += bytes.size();
  if (size_ > kMostBytes) {
    throw Error("{}: hands out a file of more than 4 GiB; this is no image", place_);
  }
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) {
      continue;
    }
    if (written <= 0) {
      throw Error("{}: cannot be written ({}); choose a folder with free space", folder_.string(),
                  std::strerror(errno));
    }
    bytes.remove_prefix(static_cast<size_t>(written));
  }
}

void IncomingSeries::end() {
  close();
  const fs::path file = folder_ / kUnfinished;
  const size_t before = instances_.size();
  check(file);
  if (instances_.size() > before) {  // else it came twice
    fs::rename(file, numbered(folder_, ++number_));
  }
}

/// Counts the file in. Throws Error if it does not belong here.
void IncomingSeries::check(const fs::path& file) {
  if (!is_dicom_file(file)) {
    throw Error("{}: hands out something that is no DICOM file; ask those who run it", place_);
  }
  const std::vector<std::uint8_t> bytes = read_file(file, kMostBytes);
  DicomElements elements(bytes, place_ + ": one of its files");
  elements.walk();
  const std::string instance = elements.text(DicomTag::kInstanceUid);
  if (instance.empty() || elements.text(DicomTag::kSeriesUid) != series_) {
    throw Error("{}: hands out an image of another series than was asked for; ask those who run it",
                place_);
  }
  const std::string patient = elements.text(DicomTag::kPatientId);
  if (has_patient_ && patient != patient_) {
    throw Error(
        "{}: this series holds images of two patients; have it corrected by those who run it",
        place_);
  }
  patient_ = patient;
  has_patient_ = true;
  if (instances_.insert(instance).second) {
    bytes_ += bytes.size();
  }
}

PartReceiver IncomingSeries::receiver() {
  return {[this] { begin(); }, [this](std::string_view bytes) { receive(bytes); },
          [this] { end(); }};
}

}  // namespace clipgs
