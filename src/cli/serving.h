#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <string>

#include "serve/server.h"

namespace clipgs {

/// What a command that serves cases is told.
struct ServingArguments {
  ServerOptions server;
  bool headset = false;

  /// Where the server can be opened at, the best one for a headset: without what follows the host.
  std::string host() const;
};

/// Adds --port, --host and --headset. `arguments` must outlive the parsing; call settle_serving()
/// after it.
void add_serving_options(CLI::App& command, ServingArguments& arguments);

/// Before the first thread is started: with --headset the address and the identity are chosen, the
/// process may open files enough, and signals that end it, or tell of renamed logs, are left to
/// serve_until(). Throws Error.
void settle_serving(const CLI::App& command, ServingArguments& arguments);

/// Prints the address: for headsets with a code that their cameras read. `query`: what follows it.
void print_address(const Server& server, const ServingArguments& arguments,
                   const std::string& query);

/// Answers requests until SIGINT, SIGTERM or `is_over`, which is asked once in a while; where there
/// are logs, SIGHUP opens them anew. Throws Error.
void serve_until(Server& server, const ServingArguments& arguments,
                 const std::function<bool()>& is_over);

/// Where programs keep what they can make again (XDG Base Directory Specification), `what` for
/// people. Throws Error if nothing says where.
std::filesystem::path cache_folder(const std::string& what);

}  // namespace clipgs
