#pragma once

#include <CLI/CLI.hpp>

namespace clipgs {

// Each adds one subcommand; its callback does the work and throws Error on failure.
// One file per command: src/cli/<name>_command.cpp.

}  // namespace clipgs
