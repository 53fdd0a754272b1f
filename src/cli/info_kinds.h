#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "splat/scene.h"

namespace clipgs {

// What `clipgs info` says of each kind of file but volumes.
bool is_case(const std::filesystem::path& path);
nlohmann::ordered_json describe_case(const std::filesystem::path& path);

nlohmann::ordered_json describe_model(const std::filesystem::path& path);

bool is_scene(const std::filesystem::path& path);
nlohmann::ordered_json describe_scene(const std::filesystem::path& path);

/// What scenes, cases and models have in common.
void describe_common(const Scene& scene, bool has_layers, nlohmann::ordered_json& json);

bool is_dataset(const std::filesystem::path& path);
nlohmann::ordered_json describe_dataset(const std::filesystem::path& path);

}  // namespace clipgs
