#pragma once

#include <optional>

#include "volume/preset.h"
#include "volume/volume.h"

namespace clipgs {

/// A volume as it was scanned and as pictures of it are traced: of finer voxels (upsample()), made
/// when they are first asked for, or as it is.
class TracedVolume {
 public:
  /// `scanned` and `preset` must outlive it.
  TracedVolume(const Volume& scanned, const Preset& preset, bool finer)
      : scanned_(scanned), preset_(preset), finer_(finer) {}

  const Volume& scanned() const { return scanned_; }
  const Volume& traced();

 private:
  const Volume& scanned_;
  const Preset& preset_;
  bool finer_;
  std::optional<Volume> fine_;
};

}  // namespace clipgs
