#pragma once

#include <filesystem>

#include "train/uniaxial_model.h"

namespace clipgs {

/// Writes a uniaxial model as a scene (write_scene: NAME.ply and NAME.json) whose PLY has one more
/// property, `threshold`, and whose JSON one more key, `model` (docs/format.md). Any program that
/// reads scenes shows it uncut. Throws Error, also if `path` does not end in .ply.
void write_model(const std::filesystem::path& path, const UniaxialModel& model);

/// Whether there is a scene at `path` that is a uniaxial model.
bool is_model(const std::filesystem::path& path);

/// Reads it back. Throws Error; for a model of another version, one that says what to do.
UniaxialModel read_model(const std::filesystem::path& path);

}  // namespace clipgs
