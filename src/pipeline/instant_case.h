#pragma once

#include <filesystem>
#include <string>

#include "pipeline/section_step.h"

#include "asset/case.h"
#include "volume/preset.h"
#include "volume/volume.h"

namespace clipgs {

/// What a case that is there at once is made with.
struct InstantOptions {
  SectionChoice section;
  bool upsample = true;  ///< as DatasetOptions::upsample; of small volumes alone, for it takes time
  std::string title;     ///< empty: the usual one of its look
};

/// A case of a volume in which nothing is learnt (method.md §13): the section, its light, and
/// Gaussians placed and coloured in closed form. Where surfaces are drawn from the section they are
/// discs on those that are lit (surface_splats()); else, of translucent matter and without a
/// section, they fill the matter. Throws Error.
Case make_instant_case(const Volume& volume, const Preset& preset, const InstantOptions& options);

/// The same of a section that is there, made of the volume by make_section(), if its surfaces can
/// be drawn.
std::optional<Case> make_placed_case(const Volume& volume, const Preset& preset, Section section,
                                     const std::string& title);

/// How a case is coded that is only to be looked at until there is a better one: by the quality
/// that was asked for, or one that is good enough for the while, as fast as may be.
CaseCoding quick_coding(const CaseCoding& asked);

/// The same into a file, coded as fast as may be. Throws Error.
void build_instant_case(const Volume& volume, const Preset& preset, const InstantOptions& options,
                        const std::filesystem::path& output);

}  // namespace clipgs
