#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/archive_volume.h"
#include "cli/commands.h"
#include "core/error.h"
#include "core/progress.h"

namespace clipgs {

namespace {

struct FetchArguments {
  std::string address;
  std::filesystem::path output;
  std::string series;
  bool json = false;
  ArchiveArguments archive;
};

/// `choice` is what --series takes, as clipgs info has it.
nlohmann::ordered_json described(const std::vector<ArchiveSeries>& list) {
  auto json = nlohmann::ordered_json::array();
  for (const ArchiveSeries& series : list) {
    json.push_back({{"choice", json.size() + 1},
                    {"uid", series.uid},
                    {"modality", series.modality},
                    {"number", series.number},
                    {"images", series.images},
                    {"taken", series.taken}});
  }
  return json;
}

void run_fetch(const FetchArguments& arguments) {
  const DicomWebAddress address = parse_dicomweb(arguments.address);
  if (!address.series.empty() && !arguments.series.empty()) {
    throw CLI::ValidationError("--series", "the address names a series already; leave one out");
  }
  const auto begin = std::chrono::steady_clock::now();
  const FetchedStudy study =
      fetch_study(address, arguments.series, arguments.archive, arguments.output);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Fetched& fetched = study.fetched;
  if (arguments.json) {
    nlohmann::ordered_json json = {{"folder", arguments.output.string()},
                                   {"files", fetched.files},
                                   {"bytes", fetched.bytes},
                                   {"seconds", seconds}};
    if (!study.series.empty()) {
      json["series"] = described(study.series);
    }
    fmt::print("{}\n", json.dump(2));
    return;
  }
  fmt::print("{}: {} files, {:.1f} MB in {}\n", arguments.output.string(), fetched.files,
             static_cast<double>(fetched.bytes) / 1e6, format_duration(seconds));
}

}  // namespace

void add_fetch_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("fetch", "A series from a hospital's archive to a folder");
  const auto arguments = std::make_shared<FetchArguments>();
  command
      ->add_option("ADDRESS", arguments->address,
                   "dicomweb+https://HOST[:PORT]/PREFIX/studies/UID[/series/UID]")
      ->required();
  command->add_option("-o,--output", arguments->output, "Folder to make, for its owner alone")
      ->required();
  command->add_option("--series", arguments->series,
                      "Series of a study, by its number in the list of --json, or by UID (default: "
                      "the one with the most images)");
  command->add_flag("--json", arguments->json, "Print JSON, with the list of series");
  add_archive_options(*command, arguments->archive);
  command->footer(
      "Proxies are those of https_proxy, http_proxy and no_proxy in the environment. What was\n"
      "interrupted goes on when it is run again. The folder holds what the archive has of the "
      "patient.\n"
      "Example: clipgs fetch dicomweb+https://pacs.example/dicom-web/studies/1.2.3 -o ct\n"
      "         clipgs fetch dicomweb+https://pacs.example/dicom-web/studies/1.2.3/series/1.2.3.4 "
      "-o ct --token-file token\n"
      "         clipgs fetch dicomweb+https://pacs.example/dicom-web/studies/1.2.3 -o ct --series "
      "2 --json");
  command->callback([arguments] { run_fetch(*arguments); });
}

}  // namespace clipgs
