#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <pthread.h>
#include <string>
#include <sys/resource.h>
#include <thread>
#include <vector>

#include "cli/commands.h"
#include "core/error.h"
#include "serve/certificate.h"
#include "serve/qr.h"
#include "serve/server.h"
#include "serve/viewer_bundle.h"
#include "study/records.h"

namespace clipgs {
namespace {

constexpr const char* kEveryAddress = "0.0.0.0";
constexpr const char* kPapersPlan = "clipgs-vr.json";

struct ServeArguments {
  ServerOptions server;
  bool headset = false;
  bool json = false;
};

/// Where programs keep what they want to find again (XDG Base Directory Specification).
std::filesystem::path state_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  if (state != nullptr && *state == '/') {
    return std::filesystem::path(state) / "clipgs";
  }
  if (home == nullptr || *home == '\0') {
    throw Error("set HOME or XDG_STATE_HOME: the server's certificate is kept there");
  }
  return std::filesystem::path(home) / ".local" / "state" / "clipgs";
}

/// Addresses that the server can be reached by from elsewhere, or else from here.
std::vector<std::string> reachable_hosts(const std::string& host) {
  const std::vector<std::string> all =
      host == kEveryAddress ? network_addresses() : std::vector<std::string>{host};
  return all.empty() ? std::vector<std::string>{"127.0.0.1"} : all;
}

void announce_to_headsets(const Server& server, const std::string& host,
                          const Certificate& certificate, const std::string& query) {
  const std::vector<std::string> hosts = reachable_hosts(host);
  fmt::print("Open this in the headset's browser, with all its letters:\n\n");
  for (const std::string& one : hosts) {
    fmt::print("  {}\n", server.url_at(one) + query);
  }
  fmt::print("\n{}\n", qr_code(server.url_at(hosts.front()) + query));
  fmt::print(
      "It warns that nobody vouches for this machine: choose Advanced, then Proceed. The\n"
      "certificate it should show has the fingerprint (SHA-256)\n  {}\n\nCtrl-C ends it.\n",
      fingerprint(certificate));
}

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
  const std::string folder = arguments.server.folder.string();
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
  const auto& identity = arguments.server.identity;
  const std::string query = study_query(arguments.server.study);
  if (!server.is_local() && !identity) {
    warn("everyone in the network can open these cases, and the connection is not encrypted");
  }
  if (arguments.json) {
    nlohmann::json text = {
        {"url", server.url_at(reachable_hosts(arguments.server.host).front()) + query},
        {"port", server.port()},
        {"cases", cases},
        {"broken", broken}};
    if (identity) {
      text["fingerprint"] = fingerprint(identity->certificate);
    }
    fmt::print("{}\n", text.dump());
  } else {
    fmt::print("{} {} in {}\n\n", cases, cases == 1 ? "case" : "cases", folder);
    if (identity) {
      announce_to_headsets(server, arguments.server.host, identity->certificate, query);
    } else {
      fmt::print("  {}\n\nCtrl-C ends it.\n", server.url() + query);
    }
  }
  std::fflush(stdout);
}

/// The certificate names every address that the server can be opened by.
ServerIdentity identity_for(const std::string& host) {
  std::vector<std::string> hosts = reachable_hosts(host);
  hosts.insert(hosts.end(), {"127.0.0.1", "localhost"});
  return load_identity(state_folder(), hosts);
}

/// Room for every connection and the case that it is given; where the system does not allow it,
/// there are fewer connections.
void allow_open_files(const ConnectionLimits& limits) {
  constexpr rlim_t kOthers = 64;
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) == 0) {
    files.rlim_cur = std::min(files.rlim_max, std::max(files.rlim_cur, 2 * limits.all + kOthers));
    ::setrlimit(RLIMIT_NOFILE, &files);
  }
}

void run_serve(ServeArguments arguments) {
  allow_open_files(arguments.server.limits);
  if (arguments.headset) {
    arguments.server.identity = identity_for(arguments.server.host);
  }
  // Every thread started from here on leaves these signals to sigwait.
  sigset_t endings;
  sigemptyset(&endings);
  sigaddset(&endings, SIGINT);
  sigaddset(&endings, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &endings, nullptr);

  Server server(arguments.server);
  announce(server, arguments);
  std::thread waiting([&] {
    int signal = 0;
    sigwait(&endings, &signal);
    server.stop();
  });
  std::exception_ptr failure;
  try {
    server.run();
  } catch (...) {
    failure = std::current_exception();
  }
  pthread_kill(waiting.native_handle(), SIGINT);  // wakes it where no signal has
  waiting.join();
  if (failure) {
    std::rethrow_exception(failure);
  }
}

}  // namespace

void add_serve_command(CLI::App& app) {
  auto arguments = std::make_shared<ServeArguments>();
  CLI::App* command =
      app.add_subcommand("serve", "Show the cases of a folder in the browser, until Ctrl-C");
  command->footer(
      "Example: clipgs serve cases --port 8080\n"
      "         clipgs serve cases --headset\n"
      "         clipgs serve cases --headset --study recorded");
  command->add_option("FOLDER", arguments->server.folder, "Folder with the *.sog cases")
      ->required();
  command->add_option("--port", arguments->server.port, "Port to listen on (0: any free one)")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  CLI::Option* host =
      command
          ->add_option("--host", arguments->server.host,
                       "Address to listen on; 0.0.0.0 opens the cases to the whole network")
          ->capture_default_str();
  command->add_flag("--headset", arguments->headset,
                    "For headsets and telephones in this network: encrypted, at every address of "
                    "this machine (--host: at one), and only for who has the whole address");
  command->add_option("--study", arguments->server.study,
                      "Folder where a user study is recorded; its first plan, *.json, or else the "
                      "papers' leads through it");
  command->add_flag("--json", arguments->json, "Print the address as one line of JSON");
  command->callback([arguments, host] {
    if (arguments->headset && host->count() == 0) {
      arguments->server.host = kEveryAddress;
    }
    run_serve(*arguments);
  });
}

}  // namespace clipgs
