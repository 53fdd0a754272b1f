#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <new>

#include "cli/commands.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/version.h"

namespace {

constexpr int kFailed = 1;
constexpr int kBadUsage = 2;

int run(int argc, char** argv) {
  CLI::App app(
      "clipgs: from a medical volume to a cinematic Gaussian scene that can be cut at any angle");
  app.name("clipgs");
  app.require_subcommand(1);
  app.set_version_flag("--version", clipgs::program_version());
  app.fallthrough();

  int threads = 0;
  bool quiet = false;
  app.add_option("--threads", threads, "Worker threads (0: all cores); never changes the result")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--quiet", quiet, "No progress");
  app.parse_complete_callback([&] {
    clipgs::set_thread_count(threads);
    clipgs::Progress::set_enabled(!quiet);
  });

  clipgs::add_archive_command(app);
  clipgs::add_bake_command(app);
  clipgs::add_build_command(app);
  clipgs::add_cinema_command(app);
  clipgs::add_completion_command(app);
  clipgs::add_dataset_command(app);
  clipgs::add_eval_command(app);
  clipgs::add_export_command(app);
  clipgs::add_fetch_command(app);
  clipgs::add_info_command(app);
  clipgs::add_looks_command(app);
  clipgs::add_man_command(app);
  clipgs::add_overview_command(app);
  clipgs::add_pack_command(app);
  clipgs::add_phantom_command(app);
  clipgs::add_refine_command(app);
  clipgs::add_render_command(app);
  clipgs::add_serve_command(app);
  clipgs::add_study_command(app);
  clipgs::add_token_command(app);
  clipgs::add_train_command(app);
  clipgs::add_unpack_command(app);
  clipgs::add_view_command(app);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : kBadUsage;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    fmt::print(
        stderr,
        "clipgs: out of memory; use a smaller volume, smaller pictures or --quality draft\n");
  } catch (const std::exception& e) {
    fmt::print(stderr, "clipgs: {}\n", e.what());
  }
  return kFailed;
}
