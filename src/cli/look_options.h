#pragma once

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "cinema/exposure.h"
#include "cinema/visible_matter.h"
#include "cli/arguments.h"
#include "cli/label_options.h"
#include "core/error.h"
#include "volume/identify.h"
#include "volume/preset.h"

namespace clipgs {

/// --preset, --rig, --exposure, --tone, --gradient-opacity and what label_options.h adds.
struct LookArguments {
  std::string preset = "auto";
  std::string rig;               ///< empty: the preset's own
  std::string exposure;          ///< a factor or "auto"; empty: the preset's own
  std::string tone;              ///< empty: the preset's own
  std::string gradient_opacity;  ///< empty: the preset's own
  bool as_scanned = false;       ///< no upsampling
  LabelArguments labels;
};

/// Adds --preset, --rig, --exposure, --tone and --gradient-opacity, which every command that
/// path-traces understands. `look` must outlive the parsing.
inline void add_look_options(CLI::App& command, LookArguments& look) {
  command.add_option("--preset", look.preset, "Look: a preset's name, a JSON file, or auto")
      ->capture_default_str();
  command.add_option("--rig", look.rig,
                     "Lights: studio, portrait, theatre, softbox, rim, dome, ambient, a JSON file, "
                     "or a panorama (.hdr, .pfm; "
                     "default: the preset's own)");
  command.add_option(
      "--exposure", look.exposure,
      "Brightness: a factor, or auto: what is bright is shown bright under any light "
      "(default: the preset's own, or auto where --rig is a panorama)");
  command
      .add_option("--tone", look.tone,
                  "Display: srgb clips what is brighter than white, filmic lets it fade into white "
                  "(default: the preset's own)")
      ->check(CLI::IsMember(std::vector<std::string>(kToneNames.begin(), kToneNames.end())));
  command.add_option(
      "--gradient-opacity", look.gradient_opacity,
      "FROM,TO[,FLOOR]: matter keeps the share FLOOR (default 0) of its extinction where values "
      "change by FROM or less per mm (HU for CT), all of it from TO on: boundaries stay, even "
      "interiors become transparent (default: the preset's own)");
  command.add_flag("--as-scanned", look.as_scanned,
                   "Trace the voxels as they are, not finer ones in which surfaces are smooth");
}

/// Whoever names a preset of another modality may mean it; it is said, for the looks of HU are
/// seldom those of a signal.
inline void warn_if_unfit(const Preset& preset, const Volume& volume) {
  const bool known = preset.modality != Modality::kUnknown && volume.modality != Modality::kUnknown;
  if (known && preset.modality != volume.modality) {
    warn(fmt::format("--preset {} is made for {}, and the volume is {}; --preset auto takes {}",
                     preset.name, modality_name(preset.modality), modality_name(volume.modality),
                     identify(volume).preset));
  }
}

/// The preset under these lights, with the looks of the volume's labels, ready to use on `volume`.
/// Throws Error.
inline Preset load_look(const LookArguments& look, const Volume& volume) {
  Preset preset = load_preset(look.preset, volume);
  warn_if_unfit(preset, volume);
  if (!look.rig.empty()) {
    preset.rig = load_rig(look.rig);
  }
  if (!look.gradient_opacity.empty()) {
    preset.gradient_opacity = parse_gradient_opacity(look.gradient_opacity);
  }
  if (!look.tone.empty()) {
    preset.tone = tone_of_name(look.tone).value();
  }
  preset.labels = load_label_looks(look.labels, volume);
  const bool automatic =
      look.exposure.empty() ? preset.rig.environment != nullptr : look.exposure == "auto";
  if (automatic) {
    const VisibleMatter matter = visible_matter(volume, preset.transfer, preset.labels);
    preset.exposure = automatic_exposure(CinemaScene(volume, preset), matter.sphere);
  } else if (!look.exposure.empty()) {
    preset.exposure = parse_numbers(look.exposure, 1, 1, "--exposure",
                                    {Preset::kLeastExposure, Preset::kMostExposure})
                          .front();
  }
  return preset;
}

}  // namespace clipgs
