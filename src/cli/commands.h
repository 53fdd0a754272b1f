#pragma once

#include <CLI/CLI.hpp>

namespace clipgs {

// Each adds one subcommand; its callback does the work and throws Error on failure.
// One file per command: src/cli/<name>_command.cpp.
void add_info_command(CLI::App& app);
void add_phantom_command(CLI::App& app);

}  // namespace clipgs
