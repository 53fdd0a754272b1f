#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "archive/archive_rules.h"
#include "archive/orthanc_client.h"
#include "archive/series_records.h"

namespace clipgs {

/// What an ArchiveWorker is told.
struct ArchiveWork {
  ArchiveRules rules;
  std::filesystem::path cases;  ///< folder that the cases are written into
  std::filesystem::path state;  ///< folder of records, and of work in progress
  bool once = false;            ///< do what there is to do now, and end
  bool retry = false;           ///< try again what failed too often
  /// Waits for so long, or less; true: it is time to end.
  std::function<bool(std::chrono::milliseconds)> pause;
};

/// Builds cases of the series in Orthanc that match rules, and puts results back. What is to be
/// done follows from what Orthanc has and the records of what was done: whatever is killed, nothing
/// is lost, and nothing that is finished is done again for the same images. One at a time: a build
/// takes all cores.
class ArchiveWorker {
 public:
  /// Throws Error if another worker has the folder of records.
  explicit ArchiveWorker(ArchiveWork work);

  /// Until it is time to end, or with `once` all is done that can be. Orthanc may come and go.
  /// Returns how many series failed; throws Error, with `once` also if Orthanc is away.
  int run();

 private:
  using Time = std::int64_t;  // s since 1970

  /// A series that is to be built, or put back.
  struct Job {
    std::string series;  ///< in Orthanc
    std::string name;
    std::vector<OrthancInstance> instances;
    std::string listing;
    const ArchiveRule& rule;
    std::string sop_class;
  };

  enum class Built { kYes, kKnown, kChanged, kStopped };

  void serve(OrthancClient& orthanc);
  void note(const std::string& series);
  void note_all(OrthancClient& orthanc);
  void read_changes(OrthancClient& orthanc);
  void note_instances(OrthancClient& orthanc, const std::vector<std::string>& instances);
  void work_at(OrthancClient& orthanc, const std::string& series);
  bool has_due();
  void wait_for_news();
  bool pause(std::chrono::milliseconds time);

  /// When it is to be looked at again; nothing: not before it changes.
  std::optional<Time> visit(OrthancClient& orthanc, const std::string& series);
  std::optional<Time> attempt(OrthancClient& orthanc, const Job& job);
  std::optional<Time> fail(const Job& job, SeriesRecord& record, const std::string& reason);
  void give_up(const Job& job, SeriesRecord& record);
  void uncount(const Job& job, SeriesRecord& record) const;
  void finish(const Job& job, SeriesRecord& record);

  Built build(OrthancClient& orthanc, const Job& job, SeriesRecord& record,
              const std::optional<SeriesRecord>& before);
  /// Into the folder of images; digest of them. "": they are others now.
  std::string fetch(OrthancClient& orthanc, const Job& job) const;
  bool run_build(const Job& job);
  void put_back(OrthancClient& orthanc, const Job& job, const SeriesRecord& record);
  void put_link(OrthancClient& orthanc, const Job& job) const;
  static bool is_unchanged(OrthancClient& orthanc, const Job& job);

  std::filesystem::path case_file(const Job& job) const;
  std::string link_to(const Job& job) const;
  void say_once(const std::string& line);

  ArchiveWork work_;
  SeriesRecords records_;
  std::vector<std::string> due_;       // series to look at, the last one first
  std::map<std::string, Time> later_;  // others, and when
  std::int64_t since_ = 0;             // the last change of Orthanc that was read
  std::int64_t woken_ = 0;             // when the file that wakes was touched last
  std::string said_;                   // the last line of what may be said often
  bool stopped_ = false;
  int failures_ = 0;
};

}  // namespace clipgs
