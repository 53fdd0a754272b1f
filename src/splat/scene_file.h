#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "splat/scene.h"
#include "splat/similarity.h"

namespace clipgs {

/// Writes a scene as NAME.ply (3DGS axes, metres: see scene_to_world()) and, beside it, NAME.json
/// with the rest of the scene (docs/format.md). Throws Error, also if `path` does not end in .ply.
void write_scene(const std::filesystem::path& path, const Scene& scene);

/// Reads both files back, into world space. Throws Error.
Scene read_scene(const std::filesystem::path& path);

/// The scene without its Gaussians as JSON; only these keys ever leave for a file. `world` is the
/// frame of the Gaussians that are stored beside it.
nlohmann::json scene_to_json(const Scene& scene, const Similarity& world);

/// Sets everything but the Gaussians from such JSON and returns the frame of the stored Gaussians.
/// `name` is what errors call it. Throws Error.
Similarity scene_from_json(const nlohmann::json& object, const std::string& name, Scene& scene);

}  // namespace clipgs
