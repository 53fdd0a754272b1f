#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <pthread.h>
#include <thread>

#include "cli/commands.h"
#include "core/error.h"
#include "serve/http.h"
#include "serve/server.h"
#include "serve/viewer_bundle.h"

namespace clipgs {
namespace {

struct ServeArguments {
  ServerOptions server;
  bool json = false;
};

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
  if (!is_loopback(arguments.server.host)) {
    warn("everyone in the network can open these cases, and the connection is not encrypted");
  }
  if (arguments.json) {
    fmt::print(
        "{}\n",
        nlohmann::json{
            {"url", server.url()}, {"port", server.port()}, {"cases", cases}, {"broken", broken}}
            .dump());
  } else {
    fmt::print("{} {} in {}\n\n  {}\n\nCtrl-C ends it.\n", cases, cases == 1 ? "case" : "cases",
               folder, server.url());
  }
  std::fflush(stdout);
}

void run_serve(const ServeArguments& arguments) {
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
  command->footer("Example: clipgs serve cases --port 8080");
  command->add_option("FOLDER", arguments->server.folder, "Folder with the *.sog cases")
      ->required();
  command->add_option("--port", arguments->server.port, "Port to listen on (0: any free one)")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
  command
      ->add_option("--host", arguments->server.host,
                   "Address to listen on; 0.0.0.0 opens the cases to the whole network")
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "Print the address as one line of JSON");
  command->callback([arguments] { run_serve(*arguments); });
}

}  // namespace clipgs
