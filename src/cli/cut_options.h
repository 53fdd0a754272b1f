#pragma once

#include <CLI/CLI.hpp>

#include "cli/arguments.h"

namespace clipgs {

/// Adds --plane and --slab, which every command that draws understands. `cut` must outlive the
/// parsing.
inline void add_cut_options(CLI::App& command, CutArguments& cut) {
  command
      .add_option("--plane", cut.planes,
                  "Cut: nx,ny,nz,c keeps n·x >= c (RAS, mm); none if not given, and given again: "
                  "what all of them keep")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      .add_option("--slab", cut.slabs,
                  "Two cuts: nx,ny,nz,c,thickness keeps c <= n·x <= c + thickness; may be given "
                  "again")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace clipgs
