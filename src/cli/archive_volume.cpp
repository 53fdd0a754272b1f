#include "cli/archive_volume.h"

#include "core/error.h"

namespace clipgs {

namespace {

void warn_if_open(const std::string& base) {
  const Url url = parse_url(base);
  if (!url.tls && !is_this_machine(url)) {
    warn(
        fmt::format("{}: the connection is not encrypted, others in the network can read pictures, "
                    "names and passwords; use dicomweb+https",
                    url.place()));
  }
}

}  // namespace

FetchedStudy fetch_study(const DicomWebAddress& address, const std::string& wanted,
                         const ArchiveArguments& archive, const std::filesystem::path& folder) {
  warn_if_open(address.base);
  HttpClient client(address.base, http_options(archive));
  DicomWebStudy study(client, address.study);
  FetchedStudy result;
  std::string series = address.series;
  if (series.empty()) {
    result.series = study.series();
    const size_t chosen = choose_series(result.series, wanted, study.place());
    result.series[chosen].taken = true;
    series = result.series[chosen].uid;
  }
  result.fetched = fetch_series(study, series, folder);
  return result;
}

GivenVolume::GivenVolume(std::string given, LoadOptions& loading, const ArchiveArguments& archive)
    : path_(std::move(given)) {
  if (!is_dicomweb(path_)) {
    return;
  }
  const DicomWebAddress address = parse_dicomweb(path_);
  folder_.emplace();
  const std::filesystem::path series = folder_->path() / "series";
  fetch_study(address, loading.series, archive, series);
  if (address.series.empty()) {
    loading.series.clear();
  }
  path_ = series.string();
}

}  // namespace clipgs
