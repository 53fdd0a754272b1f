#include <csignal>
#include <filesystem>
#include <memory>
#include <string>

#include "archive/archive_worker.h"

#include "cli/commands.h"
#include "core/error.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

struct WorkerArguments {
  fs::path rules;
  fs::path cases;
  fs::path state;
  bool once = false;
  bool retry = false;
};

/// SIGINT and SIGTERM, which are waited for from here on, and end nothing by themselves.
sigset_t take_ending_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

bool ends_within(const sigset_t& signals, milliseconds time) {
  constexpr long kNanoseconds = 1'000'000;
  const timespec pause{time.count() / 1000, time.count() % 1000 * kNanoseconds};
  return sigtimedwait(&signals, nullptr, &pause) > 0;
}

fs::path state_folder(const WorkerArguments& arguments) {
  if (!arguments.state.empty()) {
    return arguments.state;
  }
  const fs::path cases = fs::absolute(arguments.cases / "").parent_path();
  return cases.string() + ".clipgs-archive";
}

void run_archive(const WorkerArguments& arguments) {
  ArchiveWork work;
  work.rules = read_rules(arguments.rules);
  work.cases = arguments.cases;
  work.state = state_folder(arguments);
  work.once = arguments.once;
  work.retry = arguments.retry;
  const sigset_t signals = take_ending_signals();
  work.pause = [signals](milliseconds time) { return ends_within(signals, time); };
  const int failures = ArchiveWorker(std::move(work)).run();
  if (arguments.once && failures > 0) {
    throw Error("{} series could not be built or put back; what is wrong stands above", failures);
  }
}

}  // namespace

void add_archive_command(CLI::App& app) {
  const auto arguments = std::make_shared<WorkerArguments>();
  CLI::App* command = app.add_subcommand(
      "archive", "Build cases of what arrives in Orthanc, by rules, and put results back");
  command->footer(
      "It goes on until SIGTERM or Ctrl-C, and where it was, however it ended. Orthanc's user and\n"
      "password are in a file that the rules or $CLIPGS_ORTHANC_CREDENTIALS name.\n"
      "Not for diagnosis. docs/orthanc.md tells the rules, and what goes back.\n"
      "Example: clipgs archive rules.json -o cases\n"
      "         clipgs archive rules.json -o cases --once\n"
      "         clipgs archive rules.json -o /var/lib/clipgs/cases --state "
      "/var/lib/clipgs-archive");
  command->add_option("RULES", arguments->rules, "Which series are built, and how (JSON)")
      ->required();
  command->add_option("-o,--output", arguments->cases, "Folder of the cases")->required();
  command->add_option("--state", arguments->state,
                      "Folder of what was done, and of work in progress; one worker at a time has "
                      "it (default: CASES.clipgs-archive)");
  command->add_flag("--once", arguments->once, "Do what there is to do now, and end");
  command->add_flag("--retry", arguments->retry, "Try again what failed too often");
  command->callback([arguments] { run_archive(*arguments); });
}

}  // namespace clipgs
