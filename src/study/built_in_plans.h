#pragma once

#include <span>
#include <string_view>

namespace clipgs {

/// A plan of a study that the program brings: NAME of presets/study/NAME.json, and that file.
struct BuiltInPlan {
  std::string_view name;
  std::string_view json;
};

std::span<const BuiltInPlan> built_in_plans();

}  // namespace clipgs
