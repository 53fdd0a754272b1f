#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace clipgs {

// What `clipgs info` says of cases and scenes.
bool is_case(const std::filesystem::path& path);
nlohmann::ordered_json describe_case(const std::filesystem::path& path);

bool is_scene(const std::filesystem::path& path);
nlohmann::ordered_json describe_scene(const std::filesystem::path& path);

}  // namespace clipgs
