#pragma once

#include <optional>
#include <string>
#include <vector>

#include "volume/hints.h"
#include "volume/rescale.h"
#include "volume/volume.h"
#include "volume/window.h"

namespace clipgs {

/// A window to look at slices through first.
struct SuggestedWindow {
  std::string name;  ///< one of kCtWindows, "auto", or "header": what the file's header suggests
  Window window;
};

/// What a volume shows, as far as its colours, its header and its values tell.
struct Identity {
  std::string what;                          ///< for people, e.g. "CT angiography"
  std::string reason;                        ///< why that is thought, in a line
  std::string preset;                        ///< the built-in preset that suits it
  std::vector<SuggestedWindow> windows;      ///< the first suits best; none of photographs
  bool hu = false;                           ///< its values are Hounsfield units, or seem to be
  BodyRegion region = BodyRegion::kUnknown;  ///< of a CT: what its voxels tell, or else its header
  /// Of a CT: vessels full of contrast are seen, or the header speaks of an agent or angiography.
  bool contrast = false;
  std::string doubt;  ///< of the orientation, in a line; empty if it is plausible or not known
};

/// The first row of the table in identify.cpp (docs/presets.md) that fits.
Identity identify(const Volume& volume);

/// What the voxels of a CT in HU tell of the part of the body, and nothing else: a part, or what is
/// known to hold it.
BodyPart seen_part(const Volume& volume);

/// What would make HU of a volume of unknown kind whose values gather as CT's do; nothing for
/// others, and for micro-CT, which has no use for HU.
std::optional<Rescale> likely_rescale(const Volume& volume);

}  // namespace clipgs
