#include "volume/dicom_study.h"

#include <algorithm>

#include "core/error.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

DicomStudy study_of(DicomScan scan, std::string where) {
  DicomStudy study;
  study.where = std::move(where);
  study.stacks = group_into_stacks(scan.images);
  study.unreadable = std::move(scan.unreadable);
  if (!study.stacks.empty()) {
    return study;
  }
  if (!study.unreadable.empty()) {
    throw Error("{}", study.unreadable.front().error);
  }
  throw Error(
      "{}: no DICOM image with a position in it; give the folder or .zip of a CT or MR series, or "
      "a "
      ".nii(.gz), .nrrd or .mha file",
      study.where);
}

/// One file of a series stands for the series, as far as it lies in the file's own folder.
DicomStudy study_around(const fs::path& file) {
  const std::vector<DicomHeader> images = read_dicom_headers({fs::absolute(file), nullptr, 0});
  if (images.empty()) {
    throw Error("{}: a DICOM file without an image", file.string());
  }
  const DicomHeader& given = images.front();
  const fs::path folder = given.source.folder();
  DicomScan scan = scan_dicom(dicom_files_in(folder, false));
  std::erase_if(scan.images,
                [&](const DicomHeader& image) { return image.series_uid != given.series_uid; });
  DicomStudy study = study_of(std::move(scan), folder.string());
  for (size_t i = 0; i < study.stacks.size(); ++i) {
    if (std::ranges::any_of(study.stacks[i].slices, [&](const DicomHeader& slice) {
          return slice.source == given.source;
        })) {
      study.given = i;
      return study;
    }
  }
  throw Error("{}: an image without a position; give the folder of its series", file.string());
}

std::string list_of(const std::vector<DicomStack>& stacks) {
  constexpr size_t kMost = 12;
  std::string text;
  for (size_t i = 0; i < std::min(stacks.size(), kMost); ++i) {
    text += fmt::format("{} {}) {}, UID {}", i == 0 ? "" : ";", i + 1, stacks[i].describe(),
                        stacks[i].uid);
  }
  if (stacks.size() > kMost) {
    text += fmt::format("; and {} more (clipgs info lists all)", stacks.size() - kMost);
  }
  return text;
}

void warn_of_choice(const DicomStudy& study, size_t chosen) {
  warn(fmt::format("{}: {} series or phases:{}; taking {}, choose another with --series",
                   study.where, study.stacks.size(), list_of(study.stacks), chosen + 1));
}

size_t index_of(const DicomStudy& study, const std::string& series) {
  const std::vector<DicomStack>& stacks = study.stacks;
  if (series.empty()) {
    const size_t chosen = study.given.value_or(0);
    if (stacks.size() > 1) {
      warn_of_choice(study, chosen);
    }
    return chosen;
  }
  for (size_t i = 0; i < stacks.size(); ++i) {
    if (series == std::to_string(i + 1)) {
      return i;
    }
  }
  const auto found = std::ranges::find(stacks, series, &DicomStack::uid);
  if (found == stacks.end()) {
    throw Error("{}: no series \"{}\": give a number from 1 to {} or a series UID", study.where,
                series, stacks.size());
  }
  const auto chosen = static_cast<size_t>(found - stacks.begin());
  if (std::ranges::count(stacks, series, &DicomStack::uid) > 1) {
    warn_of_choice(study, chosen);  // a UID names all phases
  }
  return chosen;
}

/// A file that cannot be read must not be missed in silence, nor stop what it is no part of.
void account_for_unreadable(const DicomStudy& study, const DicomStack& stack) {
  const auto beside_a_slice = [&](const fs::path& folder) {
    return std::ranges::any_of(
        stack.slices, [&](const DicomHeader& slice) { return slice.source.folder() == folder; });
  };
  for (const UnreadableDicom& file : study.unreadable) {
    if (file.series_uid.empty() ? beside_a_slice(file.source.folder())
                                : file.series_uid == stack.uid) {
      throw Error("{}; copy it again, or take it away to go on without it", file.error);
    }
  }
  if (!study.unreadable.empty()) {
    warn(fmt::format("{}: left out {} file(s) of other series that cannot be read; the first: {}",
                     study.where, study.unreadable.size(), study.unreadable.front().error));
  }
}

}  // namespace

bool is_dicom(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored) || is_dicom_file(path) || is_zip_file(path);
}

DicomStudy open_study(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    return study_of(scan_dicom(dicom_files_in(path, true)), path.string());
  }
  if (is_zip_file(path)) {
    return study_of(scan_dicom(dicom_files_in_zip(path)), path.string());
  }
  return study_around(path);
}

size_t choose_stack(const DicomStudy& study, const std::string& series) {
  const size_t chosen = index_of(study, series);
  account_for_unreadable(study, study.stacks[chosen]);
  return chosen;
}

}  // namespace clipgs
