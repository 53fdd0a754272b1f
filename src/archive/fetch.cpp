#include "archive/fetch.h"

#include <algorithm>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "archive/incoming_series.h"

#include "core/digest.h"
#include "core/file.h"
#include "core/lock.h"
#include "core/progress.h"

namespace clipgs {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSource = "made-of";  // in the unfinished folder: whose files it holds

/// Throws Error where something is already.
void require_free(const fs::path& folder) {
  std::error_code ignored;
  if (fs::exists(folder, ignored) &&
      (!fs::is_directory(folder, ignored) || !fs::is_empty(folder, ignored))) {
    throw Error("{}: is there already; give the name of a new folder", folder.string());
  }
}

/// The folder for what comes, emptied unless it is of this source: a digest.
void prepare(const fs::path& folder, const std::string& source) {
  const fs::path file = folder / kSource;
  std::error_code ignored;
  const bool goes_on = fs::exists(file, ignored) && read_text(file) == source;
  if (!goes_on) {
    fs::remove_all(folder, ignored);
  }
  create_folder(folder);
  if (::chmod(folder.c_str(), S_IRWXU) != 0) {
    throw Error("{}: cannot be kept from others; choose a folder on another disk", folder.string());
  }
  write_text(file, source);
}

/// All that was written survives a power cut.
void sync_disk(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ::syncfs(fd);
  ::close(fd);
}

/// How many images there are, as the archive says now. Throws Error if there is none.
size_t count_of(DicomWebStudy& study, const std::string& series) {
  auto count = static_cast<size_t>(study.count(series));
  if (count == 0) {  // not said, or none: archives take longer for the list
    count = study.instances(series).size();
  }
  if (count == 0) {
    throw Error("{}: has no such series, or nothing in it; check the UID", study.place());
  }
  return count;
}

/// A receiver that says how far it is.
PartReceiver with_progress(IncomingSeries& incoming, Progress& progress) {
  PartReceiver receiver = incoming.receiver();
  receiver.end = [&incoming, &progress] {
    incoming.end();
    progress.update(incoming.instances().size(),
                    fmt::format("{:.1f} MB", static_cast<double>(incoming.bytes()) / 1e6));
  };
  return receiver;
}

/// Everything at once where nothing is there, else each image that is missing. What was cut is left
/// to another try, unless nothing came.
void retrieve(DicomWebStudy& study, const std::string& series, IncomingSeries& incoming,
              Progress& progress) {
  const size_t before = incoming.instances().size();
  const PartReceiver receiver = with_progress(incoming, progress);
  try {
    if (before == 0) {
      study.retrieve(series, receiver);
      return;
    }
    for (const std::string& instance : study.instances(series)) {
      if (!incoming.instances().contains(instance)) {
        study.retrieve(series, instance, receiver);
      }
    }
  } catch (const HttpError& error) {
    if (error.status != 0 || incoming.instances().size() == before) {
      throw;
    }
  }
}

/// Until there are as many images as the archive says, which may become more meanwhile.
void retrieve_all(DicomWebStudy& study, const std::string& series, IncomingSeries& incoming) {
  constexpr int kTries = 4;
  size_t count = count_of(study, series);
  Progress progress("fetching", count);
  for (int i = 0; incoming.instances().size() != count; ++i) {
    if (i == kTries) {
      throw Error(
          "{}: says that the series has {} images, and {} came; wait until it has all of them, and "
          "run this again",
          study.place(), count, incoming.instances().size());
    }
    if (i > 0) {
      warn(fmt::format("{}: {} of {} images came; the others are asked for by themselves",
                       study.place(), incoming.instances().size(), count));
    }
    retrieve(study, series, incoming, progress);
    count = count_of(study, series);
  }
}

}  // namespace

Fetched fetch_series(DicomWebStudy& study, const std::string& series, const fs::path& folder) {
  fs::path target = folder.lexically_normal();
  if (!target.has_filename()) {
    target = target.parent_path();
  }
  require_free(target);
  fs::path unfinished = target;
  unfinished += ".clipgs-part";
  fs::path lock_file = unfinished;
  lock_file += ".lock";
  if (target.has_parent_path()) {
    create_folder(target.parent_path());
  }
  const FileLock lock(lock_file, target, "choose another folder");
  prepare(unfinished, Digest().add(study.path()).add(series).hex());

  IncomingSeries incoming(unfinished, series, study.place());
  retrieve_all(study, series, incoming);
  fs::remove(unfinished / kSource);
  sync_disk(unfinished);
  std::error_code error;
  fs::rename(unfinished, target, error);
  if (error) {
    throw Error("{}: cannot be made of {} ({}); rename it yourself", target.string(),
                unfinished.string(), error.message());
  }
  return {incoming.instances().size(), incoming.bytes()};
}

}  // namespace clipgs
