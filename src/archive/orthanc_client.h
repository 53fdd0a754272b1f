#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "archive/archive_rules.h"
#include "archive/http_client.h"

namespace clipgs {

/// A series in Orthanc, by its identifiers there.
struct OrthancSeries {
  bool is_stable = false;                ///< no image came for its StableAge
  std::chrono::sys_seconds last_update;  ///< when the last image came
  std::vector<std::string> instances;
};

/// A stored image.
struct OrthancInstance {
  std::string id;
  std::string sop_instance;  ///< UID
  std::string stored_as;     ///< Orthanc's name of its file: another one if it was stored anew
  std::uint64_t bytes = 0;
};

/// What changed.
struct OrthancChanges {
  std::int64_t last = 0;                 ///< number of the last one
  std::vector<std::string> series{};     ///< that changed
  std::vector<std::string> instances{};  ///< that came
};

/// What an image says of its series.
struct OrthancFacts {
  SeriesFacts facts;
  std::string sop_class;  ///< UID
  bool is_image = false;  ///< it has pixels: no report, no plan
  bool is_made_by_clipgs = false;
};

/// Orthanc's REST interface, version 1.9 or newer. What it says of patients stays in the objects
/// that are asked for, and out of every error. Throws HttpError if it is away, or answers anything
/// else than what it should.
class OrthancClient {
 public:
  OrthancClient(const std::string& url, const Credentials& credentials);

  std::vector<std::string> all_series();
  std::int64_t last_change();  ///< its number
  /// Up to a thousand.
  OrthancChanges changes(std::int64_t since);
  /// Nothing: there is none, or none any more.
  std::optional<OrthancSeries> series(const std::string& id);
  std::optional<std::string> series_of(const std::string& instance);
  /// In the order of their UIDs. Empty: the series is gone.
  std::vector<OrthancInstance> instances(const std::string& series);
  std::optional<OrthancFacts> facts(const std::string& instance);
  /// The DICOM file; nothing if it is gone.
  std::optional<std::string> file(const std::string& instance);
  /// Stores a DICOM file, once however often it is stored.
  void store(const std::string& file);
  void set_metadata(const std::string& series, int number, const std::string& text);

 private:
  std::optional<nlohmann::json> find(const std::string& path);
  nlohmann::json ask(const std::string& path);
  std::string metadata(const std::string& instance, const char* name);

  HttpClient client_;
};

}  // namespace clipgs
