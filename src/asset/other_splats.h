#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "splat/scene.h"

namespace clipgs {

/// A scene of Gaussians (scene space) that nothing is known of: files of other programs say neither
/// how large a unit is nor how it lies in a patient. A unit is taken as a metre, and y as down, as
/// 3DGS and clipgs write them (scene_to_world()); the axis is z, and sphere, bounds and extent are
/// those of the middles of all but the outermost hundredth of splats.
Scene scene_of_splats(const Gaussians& gaussians);

/// Says (warn()) what scene_of_splats() takes a file for.
void warn_of_assumptions(const std::string& name);

/// Whether a file is a PLY alone, without the JSON of a scene beside it, or an SPZ.
bool is_other_splats(const std::filesystem::path& path);

/// The scene of such a file; says what was assumed of it (warn()). Throws Error.
Scene read_other_splats(const std::filesystem::path& path);

}  // namespace clipgs
