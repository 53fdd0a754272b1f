#include "archive/archive_worker.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <set>
#include <sys/stat.h>

#include "archive/build_process.h"
#include "archive/case_pictures.h"
#include "archive/case_report.h"
#include "archive/derived_objects.h"

#include "core/digest.h"
#include "core/error.h"
#include "core/file.h"
#include "core/percent.h"
#include "core/version.h"
#include "measure/build_notes.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr milliseconds kShort{100};
constexpr std::int64_t kDiskWait = 15;  // s, until a full disk is looked at again
constexpr int kBadUsage = 2;
constexpr int kSignal = 128;
constexpr int kReportPictures = 4;
constexpr const char* kLog = "log";

std::int64_t now() {
  using std::chrono::system_clock;
  return std::chrono::duration_cast<std::chrono::seconds>(system_clock::now().time_since_epoch())
      .count();
}

void say(const std::string& name, const std::string& text) {
  fmt::print(stderr, "{}: {}\n", name, text);
}

std::string listing_of(const std::vector<OrthancInstance>& instances) {
  Digest digest;
  for (const OrthancInstance& one : instances) {
    digest.add(one.sop_instance).add(one.stored_as).add(one.bytes);
  }
  return digest.hex();
}

bool tells_of_full_disk(const std::string& reason) {
  return reason.find(std::strerror(ENOSPC)) != std::string::npos ||
         reason.find(std::strerror(EDQUOT)) != std::string::npos ||
         reason.find("the disk has") != std::string::npos;  // require_free_space()
}

/// When a file was written last; 0: there is none.
std::int64_t touched(const fs::path& file) {
  struct stat status{};
  if (file.empty() || ::stat(file.c_str(), &status) != 0) {
    return 0;
  }
  return status.st_mtim.tv_sec * std::int64_t{1'000'000'000} + status.st_mtim.tv_nsec;
}

/// Images of a patient, which are gone with the object.
class ImageFolder {
 public:
  explicit ImageFolder(fs::path folder) : folder_(std::move(folder)) {
    fs::remove_all(folder_);
    create_folder(folder_.parent_path());
    if (::mkdir(folder_.c_str(), S_IRWXU) != 0) {
      throw Error("{}: the folder cannot be created ({})", folder_.string(), std::strerror(errno));
    }
  }
  ~ImageFolder() {
    std::error_code ignored;  // the next start looks for what is left
    fs::remove_all(folder_, ignored);
  }
  ImageFolder(const ImageFolder&) = delete;
  ImageFolder& operator=(const ImageFolder&) = delete;

 private:
  fs::path folder_;
};

/// Without fsync: it is fetched again rather than trusted.
void write_image(const fs::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  if (!out.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush()) {
    throw Error("{}: cannot be written ({})", file.string(), std::strerror(errno));
  }
}

fs::path image_file(const fs::path& folder, size_t index) {
  return folder / fmt::format("{:05}.dcm", index);
}

/// The line that says why a build failed, without names.
std::string reason_of(const std::string& log, int status) {
  if (status > kSignal) {
    return fmt::format("the build was ended by signal {}", status - kSignal);
  }
  std::string last;
  std::string error;
  for (size_t begin = 0; begin < log.size();) {
    const size_t end = std::min(log.find('\n', begin), log.size());
    last = log.substr(begin, end - begin);
    error = last.starts_with("clipgs: ") || (status == kBadUsage && error.empty()) ? last : error;
    begin = end + 1;
  }
  return without_names(error.empty() ? last : error);
}

std::vector<Image> some_of(const std::vector<Image>& pictures, size_t count) {
  std::vector<Image> some;
  some.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    some.push_back(pictures[i * pictures.size() / count]);
  }
  return some;
}

CaseReport report_on(const Case& contents, const std::vector<Image>& pictures, size_t slices,
                     std::uintmax_t bytes) {
  CaseReport report;
  report.title = contents.scene.title;
  report.pictures = some_of(pictures, kReportPictures);
  report.figures = {{"Slices", fmt::format("{}", slices)},
                    {"Look", contents.scene.preset},
                    {"Gaussians", fmt::format("{}", contents.scene.gaussians.size())},
                    {"Case", fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6)},
                    {"Made by", fmt::format("clipgs {}", program_version())}};
  return report;
}

}  // namespace

ArchiveWorker::ArchiveWorker(ArchiveWork work) : work_(std::move(work)), records_(work_.state) {
  create_folder(work_.cases);
  if (work_.retry) {
    records_.forget_failures();
  }
}

int ArchiveWorker::run() {
  constexpr std::chrono::seconds kLongest{30};
  std::chrono::seconds wait{1};
  while (!stopped_) {
    try {
      OrthancClient orthanc(work_.rules.orthanc, read_credentials(work_.rules));
      since_ = orthanc.last_change();
      note_all(orthanc);
      if (!said_.empty()) {
        say_once("Orthanc answers");
      }
      wait = std::chrono::seconds(1);
      serve(orthanc);
      break;
    } catch (const HttpError& error) {
      const std::string line =
          error.status == 401
              ? fmt::format("{}: does not take the credentials (401); check their file",
                            work_.rules.orthanc)
              : error.what();
      if (work_.once) {
        throw Error("{}", line);
      }
      say_once(line + "; waiting");
      pause(wait);
      wait = std::min(2 * wait, kLongest);
    }
  }
  return failures_;
}

void ArchiveWorker::serve(OrthancClient& orthanc) {
  while (!pause(milliseconds(0))) {
    read_changes(orthanc);
    if (has_due()) {
      const std::string series = due_.back();
      due_.pop_back();
      work_at(orthanc, series);
    } else if (work_.once) {
      return;
    } else {
      wait_for_news();
    }
  }
}

/// Whether it waits for its next try is in its record.
void ArchiveWorker::note(const std::string& series) {
  later_.erase(series);
  due_.push_back(series);
}

void ArchiveWorker::note_all(OrthancClient& orthanc) {
  later_.clear();
  due_ = orthanc.all_series();
}

void ArchiveWorker::read_changes(OrthancClient& orthanc) {
  const std::int64_t last = orthanc.last_change();
  if (last < since_) {  // another database: nothing is known of its past
    note_all(orthanc);
    since_ = last;
  }
  while (since_ < last) {
    const OrthancChanges changes = orthanc.changes(since_);
    since_ = std::max(changes.last, since_ + 1);
    for (const std::string& series : changes.series) {
      note(series);
    }
    note_instances(orthanc, changes.instances);
  }
}

/// The series of images that came: Orthanc, if it is killed, never says that they are complete.
void ArchiveWorker::note_instances(OrthancClient& orthanc,
                                   const std::vector<std::string>& instances) {
  std::set<std::string> known;
  for (const std::string& instance : instances) {
    const auto id = known.contains(instance) ? std::nullopt : orthanc.series_of(instance);
    if (const auto series = id ? orthanc.series(*id) : std::nullopt) {
      known.insert(series->instances.begin(), series->instances.end());
      note(*id);
    }
  }
}

bool ArchiveWorker::has_due() {
  for (auto one = later_.begin(); one != later_.end();) {
    if (one->second <= now()) {
      due_.push_back(one->first);
      one = later_.erase(one);
    } else {
      ++one;
    }
  }
  return !due_.empty();
}

void ArchiveWorker::work_at(OrthancClient& orthanc, const std::string& series) {
  std::optional<Time> again;
  try {
    again = visit(orthanc, series);
  } catch (const HttpError& error) {
    orthanc.last_change();  // throws if it is Orthanc that is away, not this series
    say_once(error.what());
    again = now() + work_.rules.retry.count();
  } catch (const std::exception& error) {  // a record that cannot be written
    say_once(without_names(error.what()));
    again = now() + kDiskWait;
  }
  if (again) {
    later_[series] = *again;
  }
}

bool ArchiveWorker::pause(milliseconds time) {
  stopped_ = stopped_ || work_.pause(time);
  return stopped_;
}

void ArchiveWorker::wait_for_news() {
  for (milliseconds waited{0}; waited < work_.rules.poll && !pause(kShort); waited += kShort) {
    if (has_due()) {
      return;
    }
    if (const std::int64_t time = touched(work_.rules.wake); time != woken_) {
      woken_ = time;
      return;
    }
  }
}

void ArchiveWorker::say_once(const std::string& line) {
  if (line != said_) {
    said_ = line;
    fmt::print(stderr, "{}\n", line);
  }
}

std::optional<ArchiveWorker::Time> ArchiveWorker::visit(OrthancClient& orthanc,
                                                        const std::string& series) {
  const std::optional<OrthancSeries> found = orthanc.series(series);
  if (!found) {
    return std::nullopt;
  }
  // After a restart Orthanc takes for stable what was about to come. Clocks may differ.
  const Time age = now() - found->last_update.time_since_epoch().count();
  const Time settle = work_.rules.settle.count();
  if (!found->is_stable || std::abs(age) < settle) {
    return now() + 1;
  }
  const std::vector<OrthancInstance> instances = orthanc.instances(series);
  const std::string name = records_.name_of(series);
  const std::string listing = listing_of(instances);
  const std::optional<SeriesRecord> record = records_.read(name);
  if (instances.empty() || (record && record->settles(listing))) {
    return std::nullopt;
  }
  if (record && record->listing == listing && record->next_try > now()) {
    return record->next_try;
  }
  const std::optional<OrthancFacts> facts = orthanc.facts(instances.front().id);
  if (!facts || !facts->is_image || facts->is_made_by_clipgs) {
    return std::nullopt;
  }
  SeriesFacts asked = facts->facts;
  if (instances.size() > 1) {
    asked.slices = static_cast<int>(instances.size());
  }
  const ArchiveRule* const rule = work_.rules.find(asked);
  if (rule == nullptr) {
    return std::nullopt;
  }
  return attempt(orthanc, {series, name, instances, listing, *rule, facts->sop_class});
}

std::optional<ArchiveWorker::Time> ArchiveWorker::attempt(OrthancClient& orthanc, const Job& job) {
  const std::optional<SeriesRecord> before = records_.read(job.name);
  SeriesRecord record;
  if (before && before->listing == job.listing) {
    record = *before;
  }
  record.rule = job.rule.name;
  record.listing = job.listing;
  if (record.tries >= work_.rules.tries) {
    record.reason = "every try was killed; is there memory enough?";
    give_up(job, record);
    return std::nullopt;
  }
  ++record.tries;  // now: whatever ends this process was a try
  records_.write(job.name, record);
  try {
    const ImageFolder images(records_.image_folder(job.name));
    const Built built =
        record.stage == SeriesStage::kPutBack ? Built::kYes : build(orthanc, job, record, before);
    if (built == Built::kStopped) {
      uncount(job, record);
      return now();
    }
    if (built == Built::kChanged) {
      return now();
    }
    if (built == Built::kYes) {
      put_back(orthanc, job, record);
    } else {
      put_link(orthanc, job);
    }
    finish(job, record);
    return std::nullopt;
  } catch (const HttpError& error) {
    uncount(job, record);
    orthanc.last_change();  // throws if it is Orthanc that is away, not an image of this series
    ++record.tries;
    return fail(job, record, error.what());
  } catch (const std::exception& error) {
    return fail(job, record, error.what());
  }
}

void ArchiveWorker::uncount(const Job& job, SeriesRecord& record) const {
  --record.tries;
  records_.write(job.name, record);
}

std::optional<ArchiveWorker::Time> ArchiveWorker::fail(const Job& job, SeriesRecord& record,
                                                       const std::string& reason) {
  constexpr Time kLongest = 3600;  // s
  if (tells_of_full_disk(reason)) {
    say_once("a disk is full: free some space; waiting");
    uncount(job, record);
    return now() + kDiskWait;
  }
  record.reason = without_names(reason);
  say(job.name, fmt::format("{} (try {} of {})", record.reason, record.tries, work_.rules.tries));
  if (record.tries >= work_.rules.tries) {
    give_up(job, record);
    return std::nullopt;
  }
  const int doublings = std::min(record.tries - 1, 20);
  ++failures_;
  record.next_try = now() + std::min(Time{work_.rules.retry.count()} << doublings, kLongest);
  records_.write(job.name, record);
  return record.next_try;
}

void ArchiveWorker::give_up(const Job& job, SeriesRecord& record) {
  ++failures_;
  record.stage = SeriesStage::kFailed;
  records_.write(job.name, record);
  fs::remove_all(records_.work_folder(job.name));
  say(job.name, fmt::format("is left alone ({}); --retry tries again", record.reason));
}

void ArchiveWorker::finish(const Job& job, SeriesRecord& record) {
  said_.clear();
  record.stage = SeriesStage::kDone;
  record.tries = 0;
  record.next_try = 0;
  record.reason.clear();
  records_.write(job.name, record);
  fs::remove_all(records_.work_folder(job.name));
}

ArchiveWorker::Built ArchiveWorker::build(OrthancClient& orthanc, const Job& job,
                                          SeriesRecord& record,
                                          const std::optional<SeriesRecord>& before) {
  const Time start = now();
  record.content = fetch(orthanc, job);
  if (record.content.empty()) {
    return Built::kChanged;
  }
  // The same images, stored anew.
  if (before && before->stage == SeriesStage::kDone && before->content == record.content &&
      fs::exists(case_file(job))) {
    return Built::kKnown;
  }
  say(job.name, fmt::format("rule {}, {} images", job.rule.name, job.instances.size()));
  if (!run_build(job)) {
    return Built::kStopped;
  }
  if (!is_unchanged(orthanc, job)) {
    say(job.name, "changed while it was built");
    return Built::kChanged;
  }
  record.stage = SeriesStage::kPutBack;
  record.tries = 1;
  records_.write(job.name, record);
  say(job.name, fmt::format("built in {} s", now() - start));
  return Built::kYes;
}

std::string ArchiveWorker::fetch(OrthancClient& orthanc, const Job& job) const {
  Digest digest;
  for (size_t i = 0; i < job.instances.size(); ++i) {
    const std::optional<std::string> file = orthanc.file(job.instances[i].id);
    if (!file) {
      return "";
    }
    write_image(image_file(records_.image_folder(job.name), i), *file);
    digest.add(job.instances[i].sop_instance).add(*file);
  }
  return digest.hex();
}

bool ArchiveWorker::is_unchanged(OrthancClient& orthanc, const Job& job) {
  return listing_of(orthanc.instances(job.series)) == job.listing;
}

fs::path ArchiveWorker::case_file(const Job& job) const {
  return work_.cases / job.rule.folder / (job.name + ".sog");
}

/// False if it is time to end. Throws Error if the build fails.
bool ArchiveWorker::run_build(const Job& job) {
  const fs::path output = case_file(job);
  const fs::path folder = records_.work_folder(job.name);
  create_folder(output.parent_path());
  std::vector<std::string> words = {
      "/proc/self/exe", "build",  records_.image_folder(job.name).string(), "-o",
      output.string(),  "--quiet"};
  if (std::ranges::find(job.rule.build, "instant") == job.rule.build.end()) {
    words.insert(words.end(), {"--work", (folder / "work").string()});
  }
  words.insert(words.end(), job.rule.build.begin(), job.rule.build.end());
  const fs::path log = folder / kLog;
  BuildProcess process(words, log);
  while (!process.status()) {
    if (pause(kShort)) {
      return false;
    }
  }
  if (const int status = process.status().value(); status != 0) {
    throw Error("{}", reason_of(read_text(log), status));
  }
  return true;
}

std::string ArchiveWorker::link_to(const Job& job) const {
  const std::string name = (fs::path(job.rule.folder) / job.name).generic_string();
  return work_.rules.public_url.empty() ? ""
                                        : work_.rules.public_url + "#case=" + percent_encode(name);
}

void ArchiveWorker::put_back(OrthancClient& orthanc, const Job& job, const SeriesRecord& record) {
  constexpr float kTurn = 4;  // s
  const BackChoice& back = job.rule.back;
  const std::string link = link_to(job);
  if (back.film || back.report) {
    const fs::path images = records_.image_folder(job.name);
    const std::optional<std::string> first = orthanc.file(job.instances.front().id);
    if (!first) {  // deleted: nothing of it goes back
      return;
    }
    write_image(image_file(images, 0), *first);
    DerivedFrom source{image_file(images, 0), {}, record.content};
    for (const OrthancInstance& one : job.instances) {
      if (!job.sop_class.empty()) {  // as some anonymised files have it: no reference can be made
        source.images.push_back({job.sop_class, one.sop_instance});
      }
    }
    const Case contents = read_case(case_file(job));
    const int count = back.film ? work_.rules.film_pictures : kReportPictures;
    const std::vector<Image> pictures = turntable(contents, count, work_.rules.film_size);
    if (back.film) {
      orthanc.store(film_object(source, {pictures, static_cast<float>(count) / kTurn, link}));
    }
    if (back.report) {
      CaseReport report =
          report_on(contents, pictures, job.instances.size(), fs::file_size(case_file(job)));
      const fs::path log = records_.work_folder(job.name) / kLog;
      report.notes = notes_of_log(fs::exists(log) ? read_text(log) : "");
      report.link = link;
      orthanc.store(report_object(source, report_pdf(report)));
    }
  }
  put_link(orthanc, job);
  say(job.name, "results are back in the archive");
}

void ArchiveWorker::put_link(OrthancClient& orthanc, const Job& job) const {
  const std::string link = link_to(job);
  if (job.rule.back.link && !link.empty()) {
    orthanc.set_metadata(job.series, work_.rules.metadata, link);
  }
}

}  // namespace clipgs
