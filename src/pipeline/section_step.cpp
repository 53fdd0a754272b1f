#include "pipeline/section_step.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "asset/section_file.h"
#include "cinema/scene.h"
#include "core/claim.h"
#include "core/error.h"
#include "section/fit_reflectance.h"
#include "volume/upsample.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

// Raised whenever the same volume and pictures give another section.
constexpr int kRevision = 6;

fs::path section_stem(const Dataset& dataset) { return dataset.folder / "section"; }
fs::path section_file(const Dataset& dataset) { return dataset.folder / "section.zip"; }

}  // namespace

std::uint64_t dataset_memory(const VolumeSize& volume, const SectionChoice& choice, bool upsample) {
  const std::uint64_t pictures = picture_memory(volume, upsample);
  if (choice.none || volume.labels) {
    return pictures;
  }
  const std::uint64_t finer = upsample ? most_upsampled(volume).loaded() : 0;
  // A build makes the section first, to show it, and then the pictures.
  return std::max(pictures + held_section_memory(volume, {choice.size}),
                  finer + section_memory(volume, {choice.size}));
}

void require_look_for_section(const Preset& preset, const SectionChoice& choice) {
  if (choice.none) {
    return;
  }
  const auto is_near = [](const KeyLight& key) { return key.distance > 0; };
  const char* const light = preset.rig.environment ? "a panorama"
                            : std::ranges::any_of(preset.rig.keys, is_near)
                                ? "a lamp at a finite \"distance\""
                                : nullptr;
  if (light != nullptr) {
    throw Error(
        "{} cannot light cut faces that are drawn from the volume: choose another --rig, or add "
        "--no-section",
        light);
  }
  if (preset.gradient_opacity) {
    throw Error(
        "gradient opacity does not reach cut faces that are drawn from the volume: do without it, "
        "or add --no-section");
  }
}

void make_dataset_section(TracedVolume& volume, const Preset& preset, const Dataset& dataset,
                          const SectionChoice& choice, std::optional<Section> made) {
  if (choice.none) {
    forget(section_stem(dataset), {section_file(dataset)});
    return;
  }
  // The pictures' claim has the volume and the look in it.
  Claim claim = claim_of_step("section", kRevision);
  claim["pictures"] = digest_of(read_claim(dataset.folder / "transforms"));
  const SectionOptions options{choice.size};
  const auto& [size] = options;  // whoever adds an option finds that this does not compile
  claim["size"] = size;
  const Step step("section", section_stem(dataset), claim, {section_file(dataset)});
  if (step.done()) {
    return;
  }
  Section section = made ? *std::exchange(made, {})
                         : make_section(volume.traced(), volume.scanned(), preset, options);
  const ReflectanceFit fit = fit_reflectance(section, dataset);
  write_section(section_file(dataset), section);
  step.finish();
  fmt::print(stderr, "section: {} x {} x {} voxels, light of the faces {:.1f} dB\n", section.dims.x,
             section.dims.y, section.dims.z, fit.psnr_after);
}

std::optional<Section> read_dataset_section(const Dataset& dataset) {
  const fs::path file = section_file(dataset);
  return fs::exists(file) ? std::optional(read_section(file)) : std::nullopt;
}

void write_scene_section(const fs::path& scene, const Section* section) {
  if (section != nullptr) {
    write_section(section_path(scene), *section);
  } else {
    fs::remove(section_path(scene));
  }
}

}  // namespace clipgs
