#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "volume/preset.h"

namespace clipgs {

/// --preset and --rig.
struct LookArguments {
  std::string preset = "auto";
  std::string rig;  ///< empty: the preset's own
};

/// Adds --preset and --rig, which every command that path-traces understands. `look` must outlive
/// the parsing.
inline void add_look_options(CLI::App& command, LookArguments& look) {
  command.add_option("--preset", look.preset, "Look: a preset's name, a JSON file, or auto")
      ->capture_default_str();
  command.add_option(
      "--rig", look.rig,
      "Lights: studio, theatre, rim, dome, ambient, a JSON file, or a panorama (.hdr; "
      "default: the preset's own)");
}

/// The preset under these lights, ready to use on `volume`. Throws Error.
inline Preset load_look(const LookArguments& look, const Volume& volume) {
  Preset preset = load_preset(look.preset, volume);
  if (!look.rig.empty()) {
    preset.rig = load_rig(look.rig);
  }
  return preset;
}

}  // namespace clipgs
