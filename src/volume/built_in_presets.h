#pragma once

#include <span>
#include <string_view>

namespace clipgs {

/// A file of presets/, compiled into the program so that it stands alone.
struct BuiltInPreset {
  std::string_view name;  ///< file stem
  std::string_view json;
};

/// Sorted by name.
std::span<const BuiltInPreset> built_in_presets();

}  // namespace clipgs
