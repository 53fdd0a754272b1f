#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "volume/volume.h"

namespace clipgs {

/// What is done to a volume between loading and tracing, where it is asked for.
struct PrepareOptions {
  std::optional<Box> crop;      ///< leave what lies in this box, RAS mm
  bool crop_to_matter = false;  ///< leave what lies around matter (voxels_of_matter())
  std::optional<float> metal;   ///< soften the streaks of what is as dense as this, HU
  bool bias = false;            ///< even out what the coils of an MR scanner did
  /// Standard deviation of noise that is averaged away, value units; 0: what is estimated.
  std::optional<float> noise;

  bool crops() const { return crop || crop_to_matter; }
  /// Whether the values before are kept for reading (Volume::scanned).
  bool keeps_scanned() const { return metal || noise; }
};

/// A step that was taken.
struct PreparationStep {
  std::string name;                                     ///< "crop", "table", ...
  std::vector<std::pair<std::string, double>> figures;  ///< what it did, units in the names
};

/// Metal and noise are taken out of the values that are traced; what is read of them (HU under a
/// pin, grey faces) stays as it was before. MR's signal has no unit: it is read as evened out.
///
/// Takes the steps in the order of PrepareOptions, and says what each did in one warning that
/// begins with `where`. Adds what it did to `steps`. Throws Error where nothing would be left.
void prepare(Volume& volume, const PrepareOptions& options, const std::string& where,
             std::vector<PreparationStep>& steps);

}  // namespace clipgs
