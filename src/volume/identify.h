#pragma once

#include <string>

#include "volume/volume.h"

namespace clipgs {

/// What a volume shows, as far as its colours, its header and its values tell.
struct Identity {
  std::string what;    ///< for people, e.g. "CT angiography"
  std::string reason;  ///< why that is thought, in a line
  std::string preset;  ///< the built-in preset that suits it
};

/// The first row of the table in identify.cpp (docs/presets.md) that fits.
Identity identify(const Volume& volume);

}  // namespace clipgs
