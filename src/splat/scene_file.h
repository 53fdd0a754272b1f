#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "splat/ply.h"
#include "splat/scene.h"
#include "splat/similarity.h"

namespace clipgs {

/// What a kind of scene keeps in its files beyond every scene.
struct SceneExtras {
  PlyColumns columns;                              ///< of NAME.ply
  nlohmann::json keys = nlohmann::json::object();  ///< of NAME.json
};

/// Writes a scene as NAME.ply (3DGS axes, metres: see scene_to_world()) and, beside it, NAME.json
/// with the rest of the scene (docs/format.md). Throws Error, also if `path` does not end in .ply.
void write_scene(const std::filesystem::path& path, const Scene& scene,
                 const SceneExtras& extras = {});

/// Reads both files back, into world space. With `extras`, fills the columns that it names, empty
/// where the file lacks one, and replaces its keys by all of NAME.json's. Throws Error.
Scene read_scene(const std::filesystem::path& path, SceneExtras* extras = nullptr);

/// The scene without its Gaussians and their layers as JSON; only these keys ever leave for a file.
/// `world` is the frame of the Gaussians that are stored beside it.
nlohmann::json scene_to_json(const Scene& scene, const Similarity& world);

/// Sets everything but the Gaussians and their layers from such JSON and returns the frame of the
/// stored Gaussians. `name` is what errors call it. Throws Error.
Similarity scene_from_json(const nlohmann::json& object, const std::string& name, Scene& scene);

}  // namespace clipgs
