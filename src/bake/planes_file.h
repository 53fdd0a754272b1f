#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "splat/scene.h"
#include "splat/similarity.h"

namespace clipgs {

/// What planes.json (docs/format.md) says of a folder of plane states.
struct PlanesFile {
  Scene scene;                     ///< states, and what is known of the rest but the Gaussians
  Similarity world;                ///< frame of the PLYs
  std::vector<std::string> files;  ///< of each state of scene.states
  std::string uncut;               ///< file of the uncut scene; empty: there is none
  // Whether the file says so; else they are to be found from the Gaussians.
  bool has_sphere = false;
  bool has_bounds = false;
  bool has_extent = false;
};

/// Throws Error, one line that says what is wrong with it: see bake_states().
PlanesFile read_planes(const std::filesystem::path& path);

/// planes.json of a scene's states. `uncut`: file of the uncut scene.
nlohmann::json planes_to_json(const PlanesFile& planes);

}  // namespace clipgs
