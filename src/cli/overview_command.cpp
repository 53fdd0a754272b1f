#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

#include "cli/commands.h"
#include "measure/overview_page.h"

namespace clipgs {

namespace {

void run_overview(const std::filesystem::path& folder) {
  using State = OverviewEntry::State;
  const std::vector<OverviewEntry> entries = write_overview(folder);
  const auto count = [&](State state) {
    return std::ranges::count(entries, state, &OverviewEntry::state);
  };
  fmt::print("{}: {} cases, {} failed, {} not finished, {} stand out\n",
             (folder / "overview" / "index.html").string(), entries.size(), count(State::kFailed),
             count(State::kUnfinished),
             std::ranges::count_if(
                 entries, [](const OverviewEntry& entry) { return !entry.reasons.empty(); }));
  for (const OverviewEntry& entry : entries) {
    if (entry.state == State::kFailed) {
      fmt::print("  {}: {}\n", entry.name, entry.failure);
    }
  }
}

}  // namespace

void add_overview_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "overview", "One page of all cases of a folder: pictures and figures, what stands out first");
  const auto folder = std::make_shared<std::filesystem::path>();
  command->add_option("FOLDER", *folder, "Folder with the *.sog cases")->required();
  command->footer(
      "Writes FOLDER/overview/index.html, with the cases' pictures beside it; clipgs serve has it\n"
      "at /overview/. Figures are those of NAME.figures (clipgs eval --json) beside a case, and\n"
      "what a batch noted.\n"
      "Example: clipgs overview cases/");
  command->callback([folder] { run_overview(*folder); });
}

}  // namespace clipgs
