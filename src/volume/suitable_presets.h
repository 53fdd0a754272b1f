#pragma once

#include <string>
#include <vector>

#include "volume/identify.h"
#include "volume/volume.h"

namespace clipgs {

/// The built-in presets that suit the volume: the automatic choice, then those rows of the table in
/// suitable_presets.cpp (docs/presets.md) that fit and show something, but not everything alike.
std::vector<std::string> suitable_presets(const Volume& volume, const Identity& identity);

}  // namespace clipgs
