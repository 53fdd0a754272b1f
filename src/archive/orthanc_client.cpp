#include "archive/orthanc_client.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <nlohmann/json.hpp>

#include "archive/derived_objects.h"

namespace clipgs {

namespace {

using nlohmann::json;

constexpr const char* kJsonType = "application/json";
constexpr const char* kDicomType = "application/dicom";

HttpOptions options_for(const Credentials& credentials) {
  HttpOptions options;
  options.user = credentials.user;
  options.password = credentials.password;
  options.connect_limit = std::chrono::seconds(5);
  options.idle_limit = std::chrono::seconds(30);
  // Twice, for a connection that Orthanc closed just now; who waits longer can be told to end.
  options.attempts = 2;
  options.first_wait = std::chrono::milliseconds(100);
  return options;
}

/// "20261128T205551", of UTC.
std::chrono::sys_seconds time_of(const std::string& text) {
  std::tm tm{};
  if (::strptime(text.c_str(), "%Y%m%dT%H%M%S", &tm) == nullptr) {
    return {};
  }
  return std::chrono::sys_seconds(std::chrono::seconds(::timegm(&tm)));
}

/// A value of one of Orthanc's simplified tags; "" if it is not there.
std::string tag_of(const json& tags, const char* name) {
  const auto found = tags.find(name);
  return found != tags.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<double> positive_number(const std::string& text) {
  const double value = std::strtod(text.c_str(), nullptr);
  return value > 0 ? std::optional(value) : std::nullopt;
}

/// What reads an answer throws if it is not as it should be: then it is not Orthanc's.
template <typename Read>
auto understand(const std::string& place, const Read& read) {
  try {
    return read();
  } catch (const json::exception&) {
    throw HttpError(0, fmt::format("{}: does not answer as Orthanc does; check the address, and "
                                   "that it is version 1.9 or newer",
                                   place));
  }
}

}  // namespace

OrthancClient::OrthancClient(const std::string& url, const Credentials& credentials)
    : client_(url, options_for(credentials)) {}

json OrthancClient::ask(const std::string& path) {
  const HttpAnswer answer = client_.get(path, kJsonType);
  return understand(client_.place(), [&] { return json::parse(answer.body); });
}

std::optional<json> OrthancClient::find(const std::string& path) {
  try {
    return ask(path);
  } catch (const HttpError& error) {
    if (error.status == 404) {
      return std::nullopt;
    }
    throw;
  }
}

std::vector<std::string> OrthancClient::all_series() {
  const json list = ask("/series");
  return understand(client_.place(), [&] { return list.get<std::vector<std::string>>(); });
}

std::int64_t OrthancClient::last_change() {
  const json answer = ask("/changes?last");
  return understand(client_.place(), [&] { return answer.at("Last").get<std::int64_t>(); });
}

OrthancChanges OrthancClient::changes(std::int64_t since) {
  constexpr int kPage = 1000;
  const json answer = ask(fmt::format("/changes?since={}&limit={}", since, kPage));
  return understand(client_.place(), [&] {
    OrthancChanges changes{answer.at("Last").get<std::int64_t>()};
    for (const json& change : answer.at("Changes")) {
      const auto id = change.at("ID").get<std::string>();
      if (change.at("ResourceType") == "Series") {
        changes.series.push_back(id);
      } else if (change.at("ChangeType") == "NewInstance") {
        changes.instances.push_back(id);
      }
    }
    return changes;
  });
}

std::optional<OrthancSeries> OrthancClient::series(const std::string& id) {
  const std::optional<json> answer = find("/series/" + id);
  if (!answer) {
    return std::nullopt;
  }
  return understand(client_.place(), [&] {
    return OrthancSeries{answer->at("IsStable").get<bool>(),
                         time_of(answer->value("LastUpdate", std::string())),
                         answer->at("Instances").get<std::vector<std::string>>()};
  });
}

std::optional<std::string> OrthancClient::series_of(const std::string& instance) {
  const std::optional<json> answer = find("/instances/" + instance);
  if (!answer) {
    return std::nullopt;
  }
  return understand(client_.place(), [&] { return answer->at("ParentSeries").get<std::string>(); });
}

std::vector<OrthancInstance> OrthancClient::instances(const std::string& series) {
  const json answer = find(fmt::format("/series/{}/instances", series)).value_or(json::array());
  std::vector<OrthancInstance> instances = understand(client_.place(), [&] {
    std::vector<OrthancInstance> all;
    for (const json& one : answer) {
      all.push_back({one.at("ID"), one.at("MainDicomTags").at("SOPInstanceUID"), one.at("FileUuid"),
                     one.at("FileSize")});
    }
    return all;
  });
  std::ranges::sort(instances, {}, &OrthancInstance::sop_instance);
  return instances;
}

std::optional<OrthancFacts> OrthancClient::facts(const std::string& instance) {
  const std::optional<json> tags = find(fmt::format("/instances/{}/simplified-tags", instance));
  if (!tags || !tags->is_object()) {
    return std::nullopt;
  }
  OrthancFacts result;
  SeriesFacts& facts = result.facts;
  facts.modality = tag_of(*tags, "Modality");
  facts.body_part = tag_of(*tags, "BodyPartExamined");
  facts.series = tag_of(*tags, "SeriesDescription");
  facts.study = tag_of(*tags, "StudyDescription");
  facts.station = tag_of(*tags, "StationName");
  facts.slices = static_cast<int>(positive_number(tag_of(*tags, "NumberOfFrames")).value_or(1));
  facts.slice_thickness = positive_number(tag_of(*tags, "SliceThickness"));
  result.sop_class = tag_of(*tags, "SOPClassUID");
  result.is_image = !tag_of(*tags, "Rows").empty();
  result.is_made_by_clipgs = tag_of(*tags, "Manufacturer") == kDerivedBy;
  facts.ae = metadata(instance, "RemoteAET");
  if (result.sop_class.empty()) {  // a file that says it before its data set alone
    result.sop_class = metadata(instance, "SopClassUid");
  }
  return result;
}

/// "" if there is none.
std::string OrthancClient::metadata(const std::string& instance, const char* name) {
  try {
    return client_.get(fmt::format("/instances/{}/metadata/{}", instance, name), "*/*").body;
  } catch (const HttpError& error) {
    if (error.status == 404) {
      return "";
    }
    throw;
  }
}

std::optional<std::string> OrthancClient::file(const std::string& instance) {
  constexpr std::uint64_t kMostFile = std::uint64_t{4} << 30U;
  try {
    return client_.get(fmt::format("/instances/{}/file", instance), kDicomType, kMostFile).body;
  } catch (const HttpError& error) {
    if (error.status == 404) {
      return std::nullopt;
    }
    throw;
  }
}

void OrthancClient::store(const std::string& file) {
  const HttpAnswer answer = client_.post("/instances", {kDicomType, file});
  const std::string status = understand(
      client_.place(), [&] { return json::parse(answer.body).at("Status").get<std::string>(); });
  if (status != "Success" && status != "AlreadyStored") {
    throw Error("{}: does not take what goes back ({}); look at its log", client_.place(), status);
  }
}

void OrthancClient::set_metadata(const std::string& series, int number, const std::string& text) {
  client_.put(fmt::format("/series/{}/metadata/{}", series, number), {"text/plain", text});
}

}  // namespace clipgs
