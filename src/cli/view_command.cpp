#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pipeline/build_case.h"
#include "pipeline/build_clock.h"

#include "cli/build_arguments.h"
#include "cli/commands.h"
#include "cli/label_options.h"
#include "cli/open_browser.h"
#include "cli/serving.h"
#include "core/claim.h"
#include "core/error.h"
#include "core/file.h"
#include "core/lock.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "serve/live_work.h"
#include "volume/load.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

// A page that is loaded again is gone for less.
constexpr std::chrono::seconds kGoneForGood(10);

struct ViewArguments {
  BuildArguments build;
  std::vector<std::string> volumes;
  std::string folder;
  ServingArguments serving;
  bool no_open = false;
};

/// Where cases, and work on them, are kept; for nobody else to read.
fs::path view_folder(const ViewArguments& arguments) {
  if (!arguments.folder.empty()) {
    create_folder(arguments.folder);
    return arguments.folder;
  }
  const fs::path folder = cache_folder("what clipgs view makes is") / "view";
  create_folder(folder);
  fs::permissions(folder, fs::perms::owner_all);
  return folder;
}

/// What tells one volume in one look from all others, and nothing else of it.
std::string digest_of_view(const fs::path& volume, const BuildArguments& build) {
  const LookArguments& look = build.look;
  Claim what = {{"volume", volume.string()},
                {"preset", look.preset},
                {"rig", look.rig},
                {"exposure", look.exposure},
                {"tone", look.tone},
                {"gradient_opacity", look.gradient_opacity},
                {"as_scanned", look.as_scanned}};
  if (build.loading.deface) {  // a case with the face is not shown meanwhile
    what["deface"] = true;
  }
  return digest_of(what).substr(0, 8);
}

/// Work that is kept under the volume's own name, which may be a patient's, goes on under a neutral
/// one.
void rename_work(const fs::path& folder, const std::string& from, const std::string& to) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().starts_with(from)) {
      found.push_back(entry.path().filename());
    }
  }
  for (const fs::path& name : found) {
    const fs::path target = folder / (to + name.string().substr(from.size()));
    if (!fs::exists(target)) {
      fs::rename(folder / name, target);
    }
  }
}

/// volume-DIGEST: the same of one volume in one look, and of no other. Pages show it, so that it
/// says nothing of the file's name.
std::string case_name(const BuildArguments& build, const fs::path& folder) {
  const fs::path path = fs::canonical(build.volume);
  fs::path stem = path.filename();
  while (stem.has_extension()) {
    stem = stem.stem();  // .nii.gz
  }
  const std::string digest = digest_of_view(path, build);
  std::string name = "volume-" + digest;
  rename_work(folder, fmt::format("{}-{}", stem.string(), digest), name);
  return name;
}

/// A case for each volume and look, by volume.
std::vector<std::vector<BuildArguments>> builds_of(const ViewArguments& arguments,
                                                   const fs::path& folder) {
  std::vector<std::vector<BuildArguments>> volumes;
  for (const std::string& volume : arguments.volumes) {
    BuildArguments build = arguments.build;
    build.volume = volume;
    require_volume(build);
    build.output = folder / (case_name(build, folder) + ".sog");
    volumes.push_back(builds_of_looks(build));
  }
  return volumes;
}

std::string name_of(const BuildArguments& build) { return fs::path(build.output).stem().string(); }

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Makes the cases, the instant ones first, and tells pages of it.
class Making {
 public:
  Making(std::vector<std::vector<BuildArguments>> volumes, LiveWork& live)
      : volumes_(std::move(volumes)), live_(live) {
    for (const auto& looks : volumes_) {
      for (const BuildArguments& build : looks) {
        live_.begin(name_of(build), fs::exists(build.output) ? build.quality : "instant");
      }
    }
  }

  void run() {
    for (const auto& looks : volumes_) {
      attempt(looks, [&] { make_instant(looks); });
    }
    for (const auto& looks : volumes_) {
      for (const BuildArguments& build : looks) {
        if (!build.instant() && !lost_.contains(name_of(build))) {
          attempt({build}, [&] { make(build); });
        }
      }
    }
    done_ = true;
  }

  bool done() const { return done_; }
  bool failed() const { return failed_; }

 private:
  /// What goes wrong with one volume is said, here and on the page, and the others go on.
  template <typename Work>
  void attempt(const std::vector<BuildArguments>& builds, const Work& work) {
    try {
      work();
    } catch (const std::exception& error) {
      fmt::print(stderr, "clipgs: {}\n", error.what());
      for (const BuildArguments& build : builds) {
        failed_ = true;
        lost_.insert(name_of(build));
        live_.end(name_of(build), for_pages(error.what(), build));
      }
    }
  }

  /// Browsers read it: the case is named, not the volume's file, nor where anything lies.
  static std::string for_pages(std::string text, const BuildArguments& build) {
    std::string volume = build.volume;
    while (volume.size() > 1 && volume.ends_with('/')) {
      volume.pop_back();
    }
    const std::string name = name_of(build);
    for (size_t at = text.find(volume); at != std::string::npos; at = text.find(volume, at)) {
      // Of a folder, or a .zip, the name of the file in it goes as well.
      const size_t end = at + volume.size();
      const size_t said = text[end] == '/' ? std::min(text.find(": ", end), text.size()) : end;
      text.replace(at, said - at, name);
      at += name.size();
    }
    const std::string folder = (fs::path(build.output).parent_path() / "").string();
    for (size_t at = text.find(folder); at != std::string::npos; at = text.find(folder, at)) {
      text.erase(at, folder.size());
    }
    return text;
  }

  void make_instant(const std::vector<BuildArguments>& looks) {
    LoadOptions loading = looks.front().loading;
    loading.warn_of_face = true;  // the first time that it is loaded
    Volume volume = load_volume(looks.front().volume, loading);
    for (const BuildArguments& build : looks) {
      const FolderLock work(work_folder(build), kAtWork);
      build_instant_first(volume, load_look(build.look, volume), options_of(build), work,
                          build.output);
      if (build.instant()) {
        live_.end(name_of(build));
      } else {
        live_.begin(name_of(build), build.quality);
      }
    }
    if (volumes_.size() == 1 && looks.size() == 1) {
      kept_ = std::move(volume);
    }
  }

  void make(const BuildArguments& build) {
    const BuildOptions options = options_of(build);
    const auto clock = std::make_shared<BuildClock>(options);
    live_.begin(name_of(build), build.quality, [clock] { return clock->left(seconds_now()); });
    Progress::set_watcher([clock](const std::string& label, double share) {
      clock->update(label, share, seconds_now());
    });
    const FolderLock work(work_folder(build), kAtWork);
    Volume volume = kept_ ? std::move(*kept_) : load_volume(build.volume, build.loading);
    const Preset preset = load_look(build.look, volume);
    build_case(std::move(volume), preset, options, work, build.output);
    Progress::set_watcher(nullptr);
    live_.end(name_of(build));
  }

  static BuildOptions options_of(const BuildArguments& build) {
    BuildArguments known = build;
    known.quality = build.instant() ? "draft" : build.quality;  // of which nothing is made
    return build_options(known);
  }

  static constexpr const char* kAtWork = "look at that one's page, or end it";

  std::vector<std::vector<BuildArguments>> volumes_;
  LiveWork& live_;
  std::optional<Volume> kept_;  // the only one, between its two cases
  std::set<std::string> lost_;  // names of cases that cannot be made
  std::atomic<bool> failed_ = false;
  std::atomic<bool> done_ = false;
};

/// Ends the process, where work may be under way: what that has finished is kept, and what it is
/// writing is not there yet.
[[noreturn]] void leave(bool done, bool failed) {
  if (!done) {
    fmt::print(stderr, "stopped; the same command goes on from here\n");
  }
  std::fflush(nullptr);
  std::_Exit(failed ? EXIT_FAILURE : EXIT_SUCCESS);
}

void run_view(ViewArguments& arguments) {
  const fs::path folder = view_folder(arguments);
  auto volumes = builds_of(arguments, folder);
  const std::string first = name_of(volumes.front().front());
  std::vector<std::pair<std::string, std::string>> shown;  // which case is of which volume
  for (const auto& looks : volumes) {
    for (const BuildArguments& build : looks) {
      arguments.serving.server.only.insert(name_of(build));
      shown.emplace_back(name_of(build), build.volume);
    }
  }
  LiveWork live;
  arguments.serving.server.folder = folder;
  arguments.serving.server.live = &live;
  Making making(std::move(volumes), live);
  Server server(arguments.serving.server);
  const std::string query = "#case=" + first;
  fmt::print("kept in {}\n", folder.string());
  for (const auto& [name, volume] : shown) {
    fmt::print("  {}: {}\n", name, volume);
  }
  fmt::print("\n");
  print_address(server, arguments.serving, query);
  std::fflush(stdout);
  if (!arguments.no_open && !arguments.serving.headset) {
    open_browser(server.url() + query);
  }
  std::thread work([&] {
    give_way();  // to the browser, which draws what there is
    making.run();
  });
  serve_until(server, arguments.serving, [&] {
    const auto deserted = live.deserted();
    return deserted && *deserted > kGoneForGood;
  });
  if (!making.done()) {
    leave(false, making.failed());
  }
  work.join();
  if (making.failed()) {
    leave(true, true);
  }
}

}  // namespace

void add_view_command(CLI::App& app) {
  const auto arguments = std::make_shared<ViewArguments>();
  CLI::App* command = app.add_subcommand(
      "view", "See a volume cut open now, and better while you watch: build and serve in one");
  command->footer(
      "The page is there at once, an instant case within seconds, and what is built takes its\n"
      "place when it is done. Close the page, or press Ctrl-C, and it stops; the same command\n"
      "goes on where it was. Of several volumes the instant cases are made first.\n"
      "Example: clipgs view dicom/\n"
      "         clipgs view head.nii.gz chest.nrrd --quality draft\n"
      "         clipgs view dicom/ --headset");
  command
      ->add_option("volumes", arguments->volumes,
                   "DICOM (folder, file or .zip), NIfTI, NRRD or MetaImage; one or several")
      ->required();
  add_build_options(*command, arguments->build);
  arguments->serving.server.port = 0;
  add_serving_options(*command, arguments->serving);
  command->add_flag("--no-open", arguments->no_open, "Print the address; open no browser");
  command->add_option("--work", arguments->folder,
                      "Folder for the cases and the work in progress (default: clipgs/view in the "
                      "user's cache, $XDG_CACHE_HOME or ~/.cache)");
  command->callback([command, arguments] {
    leave_section_to_splats(arguments->build.loading, arguments->build.section);
    if (!arguments->build.instant()) {
      build_options(arguments->build);  // there is such a quality
    }
    settle_serving(*command, arguments->serving);
    run_view(*arguments);
  });
}

}  // namespace clipgs
