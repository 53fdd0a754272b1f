#include "archive/dicomweb.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

namespace clipgs {

namespace {

using Json = nlohmann::json;

constexpr std::string_view kScheme = "dicomweb+";
constexpr const char* kStudies = "/studies/";
constexpr const char* kSeries = "/series/";
constexpr const char* kJson = "application/dicom+json";
/// Any transfer syntax: files come as they are stored.
constexpr const char* kFiles = "multipart/related; type=\"application/dicom\"; transfer-syntax=*";

constexpr size_t kPage = 1000;            // entries that are asked for at once
constexpr size_t kMostEntries = 1 << 20;  // of one list

// Attributes as DICOM's JSON model names them (PS3.18, F.2).
constexpr const char* kModality = "00080060";
constexpr const char* kInstanceUid = "00080018";
constexpr const char* kSeriesUid = "0020000E";
constexpr const char* kSeriesNumber = "00200011";
constexpr const char* kInstanceNumber = "00200013";
constexpr const char* kInstancesOfSeries = "00201209";

/// What is stored beside pictures, and what is made of them.
constexpr std::array<std::string_view, 24> kNoPictures{
    "SR",  "PR",   "KO",  "SEG", "RTSTRUCT",   "RTPLAN", "RTDOSE", "RTRECORD",
    "REG", "DOC",  "AU",  "ECG", "EPS",        "HD",     "RESP",   "PLAN",
    "FID", "ASMT", "M3D", "SMR", "TEXTUREMAP", "STAIN",  "RWV",    "ANN"};

[[noreturn]] void refuse_address() {
  throw Error(
      "this is no address of a study in an archive; give it as "
      "dicomweb+https://archive.example/dicom-web/studies/UID or …/studies/UID/series/UID");
}

/// The first value of an attribute; null where there is none.
const Json& value_of(const Json& entry, const char* attribute) {
  static const Json kNone;
  const auto found = entry.find(attribute);
  if (found == entry.end() || !found->is_object()) {
    return kNone;
  }
  const auto values = found->find("Value");
  return values == found->end() || !values->is_array() || values->empty() ? kNone : values->front();
}

std::string text_of(const Json& entry, const char* attribute) {
  const Json& value = value_of(entry, attribute);
  return value.is_string() ? value.get<std::string>() : "";
}

/// Archives write integer strings as numbers, and as strings.
int number_of(const Json& entry, const char* attribute) {
  const Json& value = value_of(entry, attribute);
  int number = 0;
  if (value.is_string()) {
    const std::string text = value.get<std::string>();
    std::from_chars(text.data(), text.data() + text.size(), number);
  } else if (value.is_number()) {
    constexpr double kMost = 1e9;
    number = static_cast<int>(std::clamp(value.get<double>(), -kMost, kMost));
  }
  return number;
}

/// "CT", or nothing: whatever else an archive writes there is not repeated.
std::string code_of(const Json& entry, const char* attribute) {
  const std::string text = text_of(entry, attribute);
  constexpr size_t kLongest = 16;  // of a code string
  const bool is_code =
      text.size() <= kLongest && std::ranges::all_of(text, [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == ' ';
      });
  return is_code ? text : "";
}

/// All entries of a list that archives cut into pages, by `key`, the UID of an entry. Where one
/// knows no pages, the second time nothing is new.
std::vector<Json> all_pages(HttpClient& client, const std::string& query, const char* key) {
  std::vector<Json> all;
  std::set<std::string> known;
  for (;;) {
    const HttpAnswer answer =
        client.get(fmt::format("{}{}limit={}&offset={}", query,
                               query.find('?') == std::string::npos ? '?' : '&', kPage, all.size()),
                   kJson);
    if (answer.head.status == 204) {
      return all;
    }
    const Json page = Json::parse(answer.body, nullptr, false);
    if (!page.is_array()) {
      throw Error(
          "{}: answers something else than DICOMweb, a page for browsers perhaps; check "
          "the address, which often ends in /dicom-web or /rs before /studies",
          client.place());
    }
    const size_t before = all.size();
    for (const Json& entry : page) {
      const std::string uid = entry.is_object() ? text_of(entry, key) : "";
      if (is_uid(uid) && known.insert(uid).second) {
        all.push_back(entry);
      }
    }
    if (all.size() == before) {
      return all;
    }
    if (all.size() > kMostEntries) {
      throw Error("{}: its list does not end; ask those who run it", client.place());
    }
  }
}

}  // namespace

bool is_uid(std::string_view text) {
  constexpr size_t kLongest = 64;
  return !text.empty() && text.size() <= kLongest &&
         text.find_first_not_of("0123456789.") == std::string_view::npos && text.front() != '.' &&
         text.back() != '.' && text.find("..") == std::string_view::npos;
}

bool is_dicomweb(std::string_view text) { return text.starts_with(kScheme); }

DicomWebAddress parse_dicomweb(std::string_view text) {
  text.remove_prefix(std::min(kScheme.size(), text.size()));
  while (text.ends_with('/')) {
    text.remove_suffix(1);
  }
  const size_t studies = text.rfind(kStudies);
  if (studies == std::string_view::npos) {
    refuse_address();
  }
  DicomWebAddress address;
  address.base = text.substr(0, studies);
  std::string_view rest = text.substr(studies + std::string_view(kStudies).size());
  const size_t series = rest.find(kSeries);
  if (series != std::string_view::npos) {
    address.series = rest.substr(series + std::string_view(kSeries).size());
    rest = rest.substr(0, series);
  }
  address.study = rest;
  parse_url(address.base);
  if (!is_uid(address.study) || (series != std::string_view::npos && !is_uid(address.series))) {
    refuse_address();
  }
  return address;
}

bool ArchiveSeries::shows_pictures() const {
  return std::ranges::find(kNoPictures, modality) == kNoPictures.end();
}

std::string ArchiveSeries::describe() const {
  return fmt::format("{}, series {}, {} images", modality, number, images);
}

DicomWebStudy::DicomWebStudy(HttpClient& client, std::string study)
    : client_(client), path_(kStudies + std::move(study)) {}

std::vector<ArchiveSeries> DicomWebStudy::list(const std::string& query) {
  std::vector<ArchiveSeries> found;
  for (const Json& entry : all_pages(
           client_, fmt::format("{}/series?includefield={}{}", path_, kInstancesOfSeries, query),
           kSeriesUid)) {
    found.push_back({text_of(entry, kSeriesUid), code_of(entry, kModality),
                     number_of(entry, kSeriesNumber),
                     std::max(number_of(entry, kInstancesOfSeries), 0)});
  }
  return found;
}

std::vector<ArchiveSeries> DicomWebStudy::series() {
  std::vector<ArchiveSeries> all = list("");
  for (ArchiveSeries& one : all) {
    if (one.images == 0) {
      one.images = static_cast<int>(instances(one.uid).size());
    }
  }
  std::ranges::sort(all, {}, [](const ArchiveSeries& one) {
    return std::tuple(!one.shows_pictures(), -one.images, one.number, one.uid);
  });
  return all;
}

int DicomWebStudy::count(const std::string& series) {
  for (const ArchiveSeries& one : list(fmt::format("&SeriesInstanceUID={}", series))) {
    if (one.uid == series) {
      return one.images;
    }
  }
  return 0;
}

std::vector<std::string> DicomWebStudy::instances(const std::string& series) {
  std::vector<std::pair<int, std::string>> numbered;
  for (const Json& entry :
       all_pages(client_, path_ + kSeries + series + "/instances", kInstanceUid)) {
    numbered.emplace_back(number_of(entry, kInstanceNumber), text_of(entry, kInstanceUid));
  }
  std::ranges::sort(numbered);
  std::vector<std::string> uids;
  uids.reserve(numbered.size());
  for (auto& [number, uid] : numbered) {
    uids.push_back(std::move(uid));
  }
  return uids;
}

void DicomWebStudy::retrieve_from(const std::string& path, const PartReceiver& receiver) {
  std::optional<MultipartReader> reader;
  client_.get(path, kFiles,
              {[&](const AnswerHead& head) {
                 reader.emplace(head.content_type, client_.place(), receiver);
               },
               [&](std::string_view bytes) { reader->read(bytes); }});
  if (!reader || !reader->is_complete()) {
    throw HttpError(0, fmt::format("{}: its answer was cut; try again", client_.place()));
  }
}

void DicomWebStudy::retrieve(const std::string& series, const PartReceiver& receiver) {
  retrieve_from(path_ + kSeries + series, receiver);
}

void DicomWebStudy::retrieve(const std::string& series, const std::string& instance,
                             const PartReceiver& receiver) {
  retrieve_from(path_ + kSeries + series + "/instances/" + instance, receiver);
}

namespace {

std::string list_of(const std::vector<ArchiveSeries>& list) {
  constexpr size_t kMost = 12;
  std::string text;
  for (size_t i = 0; i < std::min(list.size(), kMost); ++i) {
    text += fmt::format("{} {}) {}", i == 0 ? "" : ";", i + 1, list[i].describe());
  }
  return list.size() > kMost ? text + fmt::format("; and {} more", list.size() - kMost) : text;
}

}  // namespace

size_t choose_series(const std::vector<ArchiveSeries>& list, const std::string& wanted,
                     const std::string& where) {
  if (list.empty()) {
    throw Error("{}: has no such study, or nothing in it; check the UID", where);
  }
  if (wanted.empty()) {
    if (!list.front().shows_pictures()) {
      throw Error("{}: a study without images:{}; give another one", where, list_of(list));
    }
    if (list.size() > 1) {
      warn(fmt::format("{}: {} series:{}; taking 1, choose another with --series", where,
                       list.size(), list_of(list)));
    }
    return 0;
  }
  for (size_t i = 0; i < list.size(); ++i) {
    if (wanted == list[i].uid || wanted == std::to_string(i + 1)) {
      return i;
    }
  }
  throw Error("{}: no series \"{}\": give a number from 1 to {} or a series UID", where, wanted,
              list.size());
}

}  // namespace clipgs
