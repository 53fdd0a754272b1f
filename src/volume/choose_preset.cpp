#include "volume/histogram.h"
#include "volume/preset.h"

namespace clipgs {
namespace {

// A CT without air or fat (values clamped at about 0, as viewers of angiographies store them) has
// nothing to tell tissue from background: only contrast and bone can be shown.
constexpr float kAirMissing = -300;

const char* preset_for(const Volume& volume) {
  switch (volume.modality) {
    case Modality::kPhoto:
      return "photo";
    case Modality::kMr:
      return "mr";
    case Modality::kCt:
      return histogram(volume).min > kAirMissing ? "vessels" : "soft-tissue";
    case Modality::kUnknown:
      break;
  }
  return "generic";
}

}  // namespace

Preset choose_preset(const Volume& volume) { return load_preset(preset_for(volume), volume); }

}  // namespace clipgs
