#pragma once

#include <span>
#include <string_view>

namespace clipgs {

/// A file of presets/, compiled into the program so that it stands alone.
struct BuiltInFile {
  std::string_view name;  ///< stem
  std::string_view json;
};

/// presets/*.json and presets/rigs/*.json, each sorted by name.
std::span<const BuiltInFile> built_in_presets();
std::span<const BuiltInFile> built_in_rigs();

}  // namespace clipgs
