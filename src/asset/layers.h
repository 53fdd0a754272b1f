#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "asset/zip.h"
#include "splat/scene.h"

namespace clipgs {

/// Appends the layers of a scene as an image (docs/format.md) to `files`, states its checksum in
/// `meta` and returns its name.
/// `order`: of each splat of the SOG its index in the scene. Throws Error if a splat has no layer
/// or one that is no state of the scene.
std::string encode_layers(const Scene& scene, std::span<const size_t> order,
                          std::vector<ZipEntry>& files, nlohmann::json& meta);

/// Reads them back from the image `file` of `files`; `meta` states its checksum; of `scene`, the
/// Gaussians and states are asked. Throws Error, `name` in it.
std::vector<std::uint16_t> decode_layers(const std::string& file,
                                         const std::map<std::string, Bytes>& files,
                                         const nlohmann::json& meta, const Scene& scene,
                                         const std::string& name);

}  // namespace clipgs
