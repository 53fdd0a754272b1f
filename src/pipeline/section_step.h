#pragma once

#include <filesystem>
#include <optional>

#include "asset/case.h"
#include "cinema/dataset.h"
#include "cinema/traced_volume.h"
#include "section/section.h"

namespace clipgs {

// The section on its way from the volume to the case: DATASET/section.zip, SCENE.section.zip, CASE.

/// What section a case shall have.
struct SectionChoice {
  int size = SectionOptions().size;  ///< as many voxels as a cube of such a side, at most
  bool none = false;
  CaseCoding coding;
};

/// Throws Error if cut faces drawn from the volume cannot look as the preset says.
void require_look_for_section(const Preset& preset, const SectionChoice& choice);

/// Bytes of memory that a dataset and its section take beside a volume, while the other is made.
std::uint64_t dataset_memory(const VolumeSize& volume, const SectionChoice& choice, bool upsample);

/// Writes the section of a volume, with its light fitted to the dataset's pictures, beside them,
/// unless it is there already. `choice.none`: removes the one that is there. `made`: what
/// make_section() makes of all that, if somebody has it.
void make_dataset_section(TracedVolume& volume, const Preset& preset, const Dataset& dataset,
                          const SectionChoice& choice, std::optional<Section> made = {});

/// The dataset's section, if it has one.
std::optional<Section> read_dataset_section(const Dataset& dataset);

/// Puts a section beside a scene; null: removes one that lies there.
void write_scene_section(const std::filesystem::path& scene, const Section* section);

}  // namespace clipgs
