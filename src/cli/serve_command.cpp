#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/service_options.h"
#include "cli/serving.h"
#include "core/error.h"
#include "serve/certificate.h"
#include "serve/viewer_bundle.h"
#include "study/records.h"

namespace clipgs {
namespace {

constexpr const char* kPapersPlan = "clipgs-vr.json";

struct ServeArguments {
  ServingArguments serving;
  CertificateFiles files;
  bool json = false;
};

/// What leads an address to a study: the first plan in its folder, or else the papers'.
std::string study_query(const std::filesystem::path& folder) {
  if (folder.empty()) {
    return "";
  }
  std::vector<std::string> plans;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".json" && is_study_name(entry.path().stem().string())) {
      plans.push_back(entry.path().filename().string());
    }
  }
  return "?study=" + (plans.empty() ? kPapersPlan : *std::ranges::min_element(plans));
}

void announce(const Server& server, const ServeArguments& arguments) {
  const size_t cases = server.case_count();
  const size_t broken = server.broken_count();
  const std::string folder = arguments.serving.server.folder.string();
  if (cases == 0) {
    warn(fmt::format("{}: holds no case yet; put *.sog files there (clipgs build makes them)",
                     folder));
  }
  if (broken > 0) {
    warn(fmt::format("{}: {} of the *.sog files cannot be shown; the viewer's menu says why",
                     folder, broken));
  }
  if (viewer_files().empty()) {
    warn("this program was built without its viewer: only /api and /cases are there");
  }
  const auto& identity = arguments.serving.server.identity;
  const std::string query = study_query(arguments.serving.server.study);
  const bool is_open =
      arguments.serving.server.tokens.empty() && (!identity || identity->token.empty());
  if (!server.is_local() && is_open) {
    warn(fmt::format(
        "everyone in the network can open these cases{}",
        identity ? "; --tokens lets in only some" : ", and the connection is not encrypted"));
  }
  if (arguments.json) {
    nlohmann::json text = {{"url", server.url_at(arguments.serving.host()) + query},
                           {"port", server.port()},
                           {"cases", cases},
                           {"broken", broken}};
    if (identity) {
      text["fingerprint"] = fingerprint(identity->certificate);
    }
    fmt::print("{}\n", text.dump());
  } else {
    fmt::print("{} {} in {}\n\n", cases, cases == 1 ? "case" : "cases", folder);
    if (!arguments.serving.server.tokens.empty()) {
      fmt::print("Each opens it with a token behind the address (clipgs token {}).\n\n",
                 arguments.serving.server.tokens.string());
    }
    print_address(server, arguments.serving, query);
  }
  std::fflush(stdout);
}

void run_serve(const ServeArguments& arguments) {
  Server server(arguments.serving.server);
  announce(server, arguments);
  serve_until(server, arguments.serving, [] { return false; });
}

}  // namespace

void add_serve_command(CLI::App& app) {
  auto arguments = std::make_shared<ServeArguments>();
  CLI::App* command =
      app.add_subcommand("serve", "Show the cases of a folder in the browser, until Ctrl-C");
  command->footer(
      "Example: clipgs serve cases --port 8080\n"
      "         clipgs serve cases --headset\n"
      "         clipgs serve cases --keep-marks\n"
      "         clipgs serve cases --headset --study recorded\n"
      "         clipgs serve cases --tokens tokens.json --audit audit.jsonl --access-log -");
  command->add_option("FOLDER", arguments->serving.server.folder, "Folder with the *.sog cases")
      ->required();
  add_serving_options(*command, arguments->serving);
  command->add_option("--study", arguments->serving.server.study,
                      "Folder where a user study is recorded; its first plan, *.json, or else the "
                      "papers' leads through it");
  command->add_flag("--keep-marks", arguments->serving.server.keeps.marks,
                    "Let everyone who can open the cases change their marks, which are kept beside "
                    "each case as NAME.marks.json");
  command->add_flag("--keep-tours", arguments->serving.server.keeps.tours,
                    "The same of their saved views, as NAME.tour.json");
  add_service_options(*command, arguments->serving.server, arguments->files);
  command->add_flag("--json", arguments->json, "Print the address as one line of JSON");
  command->callback([command, arguments] {
    settle_serving(*command, arguments->serving);
    settle_service(arguments->files, arguments->serving.server);
    run_serve(*arguments);
  });
}

}  // namespace clipgs
