#pragma once

#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "asset/webp.h"
#include "asset/zip.h"
#include "splat/gaussians.h"

namespace clipgs {

/// What a SOG holds, without its images.
struct SogSummary {
  size_t count = 0;  ///< splats
  int sh_degree = 0;
  bool face_colors = false;
};

/// Splats that a SOG may hold here.
constexpr size_t kMaxSplats = size_t{4} << 20;

/// Told how many bytes a SOG hardly takes less than, says how many it may take.
using SogRoom = std::function<size_t(size_t least)>;

/// Quantises `gaussians` (scene space) as SOG v2: appends the images to `files` and returns
/// meta.json; face colours and the images' checksums are keys of our own in it. Splats come out in
/// Morton order; the result depends neither on the order they came in nor on the number of threads.
/// `order`, unless null, is set to the index in `gaussians` of each splat of the SOG. Colours above
/// degree 0 are a palette with a centroid for every 16 splats, or for as few as 2 where the images
/// then take no more than there is `room` for (none: 16). Throws Error if there are no splats, too
/// many, or one that is not finite.
nlohmann::json encode_sog(const Gaussians& gaussians, std::vector<ZipEntry>& files,
                          std::vector<size_t>* order = nullptr, const SogRoom& room = {});

/// An image of a SOG with a texel for each of `count` splats, all (0, 0, 0, 255).
Texels splat_texels(size_t count);

/// What meta.json says of its splats. Throws Error, `name` in it, if it is not SOG v2.
SogSummary sog_summary(const nlohmann::json& meta, const std::string& name);

/// The Gaussians (scene space) of a SOG v2. Throws Error, `name` in it, on whatever is missing,
/// out of range, undecodable or decoded to something else than its checksum says.
Gaussians decode_sog(const nlohmann::json& meta, const std::map<std::string, Bytes>& files,
                     const std::string& name);

}  // namespace clipgs
