#include "cli/serving.h"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <thread>
#include <vector>

#include "core/error.h"
#include "serve/certificate.h"
#include "serve/qr.h"

namespace clipgs {
namespace {

constexpr const char* kEveryAddress = "0.0.0.0";

/// A folder of the XDG Base Directory Specification, for this program.
std::filesystem::path xdg_folder(const char* variable, const std::filesystem::path& usual,
                                 const std::string& what) {
  const char* folder = std::getenv(variable);
  const char* home = std::getenv("HOME");
  if (folder != nullptr && *folder == '/') {
    return std::filesystem::path(folder) / "clipgs";
  }
  if (home == nullptr || *home == '\0') {
    throw Error("set HOME or {}: {} kept there", variable, what);
  }
  return std::filesystem::path(home) / usual / "clipgs";
}

/// Addresses that the server can be reached by from elsewhere, or else from here.
std::vector<std::string> reachable_hosts(const std::string& host) {
  const std::vector<std::string> all =
      host == kEveryAddress ? network_addresses() : std::vector<std::string>{host};
  return all.empty() ? std::vector<std::string>{"127.0.0.1"} : all;
}

void print_to_headsets(const Server& server, const std::string& host,
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

/// The certificate names every address that the server can be opened by.
ServerIdentity identity_for(const std::string& host) {
  std::vector<std::string> hosts = reachable_hosts(host);
  hosts.insert(hosts.end(), {"127.0.0.1", "localhost"});
  return load_identity(xdg_folder("XDG_STATE_HOME", ".local/state", "the server's certificate is"),
                       hosts);
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

/// Those that end the process, and the one that tells of renamed logs: without these it ends the
/// process, too, as that of a closed terminal does.
sigset_t signals_of(const ServerOptions& options) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  if (!options.access_log.empty() || !options.audit.empty()) {
    sigaddset(&signals, SIGHUP);
  }
  return signals;
}

}  // namespace

std::string ServingArguments::host() const { return reachable_hosts(server.host).front(); }

void add_serving_options(CLI::App& command, ServingArguments& arguments) {
  command.add_option("--port", arguments.server.port, "Port to listen on (0: any free one)")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      .add_option("--host", arguments.server.host,
                  "Address to listen on; 0.0.0.0 opens the cases to the whole network")
      ->capture_default_str();
  command.add_flag("--headset", arguments.headset,
                   "For headsets and telephones in this network: encrypted, at every address of "
                   "this machine (--host: at one), and only for who has the whole address");
}

void settle_serving(const CLI::App& command, ServingArguments& arguments) {
  if (arguments.headset && command.get_option("--host")->count() == 0) {
    arguments.server.host = kEveryAddress;
  }
  allow_open_files(arguments.server.limits);
  if (arguments.headset) {
    arguments.server.identity = identity_for(arguments.server.host);
  }
  // Every thread started from here on leaves these signals to sigtimedwait.
  const sigset_t signals = signals_of(arguments.server);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
}

void print_address(const Server& server, const ServingArguments& arguments,
                   const std::string& query) {
  if (arguments.headset) {
    print_to_headsets(server, arguments.server.host, arguments.server.identity->certificate, query);
  } else {
    fmt::print("  {}\n\nCtrl-C ends it.\n", server.url() + query);
  }
}

void serve_until(Server& server, const ServingArguments& arguments,
                 const std::function<bool()>& is_over) {
  std::atomic<bool> failed = false;
  std::thread waiting([&] {
    const sigset_t signals = signals_of(arguments.server);
    const timespec pause{0, 500'000'000};
    int signal = -1;
    while ((signal < 0 || signal == SIGHUP) && !failed && !is_over()) {
      signal = sigtimedwait(&signals, nullptr, &pause);
      if (signal == SIGHUP) {
        server.reopen_logs();
      }
    }
    server.stop();
  });
  std::exception_ptr failure;
  try {
    server.run();
  } catch (...) {
    failure = std::current_exception();
    failed = true;
  }
  waiting.join();
  if (failure) {
    std::rethrow_exception(failure);
  }
}

std::filesystem::path cache_folder(const std::string& what) {
  return xdg_folder("XDG_CACHE_HOME", ".cache", what);
}

}  // namespace clipgs
