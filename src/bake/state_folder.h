#pragma once

#include <filesystem>

#include "bake/bake.h"

namespace clipgs {

/// Name of the file that says which planes a folder's states belong to.
constexpr const char* kPlanesFile = "planes.json";

/// Writes the plane states of a model (choose_states) as 3DGS PLYs that any program reads, and
/// planes.json beside them (docs/format.md): state_000.ply …, in scene space, each with all
/// Gaussians of the model in its order, hidden ones transparent; and uncut.ply. Throws Error, also,
/// before anything is written, if the disk has no room for them.
void export_states(const UniaxialModel& model, int state_count, const std::filesystem::path& folder,
                   const BakeProgress& progress = {});

/// Consolidates a folder of plane states, made by clipgs or by any other ClipGS: the PLYs of
/// `folder` that `planes` (planes.json) lists, one in memory at a time. A Gaussian is shown by a
/// state if its opacity there is 1/255 or more. SH above order 0 come from the first state, from
/// below, that shows the Gaussian; warns if they differ between states. Throws Error, one line with
/// the file that is wrong, if one is missing or unreadable, if states differ in their numbers of
/// splats or SH degree, or if the planes are fewer than two, not parallel, not of one kept side,
/// out of order, or more than 1 % off even spacing.
BakedScene bake_states(const std::filesystem::path& folder, const std::filesystem::path& planes,
                       const BakeProgress& progress = {});

}  // namespace clipgs
