#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "core/tone.h"
#include "volume/boundary_look.h"
#include "volume/gradient_opacity.h"
#include "volume/label_looks.h"
#include "volume/light_rig.h"
#include "volume/transfer_function.h"
#include "volume/volume.h"

namespace clipgs {

/// What the transfer function's values mean.
enum class ValueUnits {
  kStored,      ///< HU for CT, otherwise the volume's stored unit
  kPercentile,  ///< 0…100 of the volume's foreground; resolve_percentiles() turns them into values
  kPercentileOfAll,  ///< the same of all its voxels: what is rare and bright keeps its place
};

/// Everything that says how a volume looks: one file of presets/ (docs/presets.md).
struct Preset {
  static constexpr float kLeastExposure = 1e-4f;
  static constexpr float kMostExposure = 1e4f;

  std::string name;         ///< file stem, e.g. "skin-and-bone"
  std::string title;        ///< for people
  std::string description;  ///< one sentence
  Modality modality = Modality::kUnknown;
  ValueUnits units = ValueUnits::kStored;
  TransferFunction transfer;
  float surface_strength = 1;  ///< k of P(surface) = 1 − exp(−k·‖∇v‖), per (value unit / mm)
  std::optional<GradientOpacity> gradient_opacity;  ///< nothing: a factor of 1 everywhere
  std::optional<BoundaryLook> boundary;             ///< nothing: the value alone says it
  LightRig rig;
  float exposure = 1;  ///< linear factor before the tone curve
  ToneCurve tone = ToneCurve::kSrgb;
  LabelLooks labels;  ///< of a volume with labels; no part of a preset's file

  DisplayTransform display() const { return {exposure, tone}; }
};

/// Names of the built-in light rigs, sorted.
std::vector<std::string> rig_names();

/// A built-in light rig by name, a JSON file, or a panorama by path (.hdr or .pfm, finite and not
/// black, made as bright as `studio` is; a warning unless it is twice as wide as high). Throws
/// Error that lists the names.
LightRig load_rig(const std::string& name_or_path);

/// Parses a preset; `where` names the source in errors. Throws Error.
Preset parse_preset(const std::string& text, const std::string& name, const std::string& where);

/// Names of the built-in presets, sorted.
std::vector<std::string> preset_names();

/// A built-in preset by name, or a JSON file by path, as written: percentiles are not resolved, so
/// prefer the overload that takes the volume. Throws Error that lists the names.
Preset load_preset(const std::string& name_or_path);

/// Turns percentiles of the foreground (values above Otsu's threshold), or of all voxels, into the
/// volume's values, and surface_strength, gradient_opacity and the boundary's ends from "per p1–p99
/// range" into "per value unit". Of a volume of one value every percentile is that value, and no
/// place of it is steep. Other presets are left as they are.
void resolve_percentiles(Preset& preset, const Volume& volume);

/// The preset that suits the volume's modality and histogram, ready to use on it.
Preset choose_preset(const Volume& volume);

/// A preset ready to use on `volume`; `name` may be "auto".
Preset load_preset(const std::string& name, const Volume& volume);

}  // namespace clipgs
