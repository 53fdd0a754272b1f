#include "cli/section_step.h"

#include <algorithm>
#include <fmt/format.h>

#include "asset/section_file.h"
#include "core/error.h"
#include "section/fit_reflectance.h"

namespace clipgs {

namespace {

namespace fs = std::filesystem;

fs::path section_file(const Dataset& dataset) { return dataset.folder / "section.zip"; }

}  // namespace

void add_section_options(CLI::App& command, SectionChoice& choice) {
  command
      .add_option("--section-size", choice.size,
                  "Voxels along each side, at most, of the section: the volume that cut faces are "
                  "drawn from")
      ->check(CLI::Range(8, 1024))
      ->capture_default_str();
  command.add_flag("--no-section", choice.none,
                   "No section: splats fill the cut faces (always so with --labels)");
}

void add_section_coding(CLI::App& command, SectionChoice& choice) {
  command
      .add_option("--section-quality", choice.coding.section_quality,
                  "Of the section's image in the case: 100 is lossless (default: the best that "
                  "--max-mb leaves room for, 90 at least)")
      ->check(CLI::Range(1.0, 100.0));
  command
      .add_option_function<double>(
          "--max-mb", [&choice](double mb) { choice.coding.bytes = static_cast<size_t>(1e6 * mb); },
          "What the case should take at most, MB; less loses more of the section and of the "
          "splats' colours (default 5)")
      ->check(CLI::Range(0.0, 1000.0));
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

void make_dataset_section(const Volume& volume, const Preset& preset, const Dataset& dataset,
                          const SectionChoice& choice) {
  if (choice.none) {
    fs::remove(section_file(dataset));
    return;
  }
  Section section = make_section(volume, preset, {choice.size});
  const ReflectanceFit fit = fit_reflectance(section, dataset);
  write_section(section_file(dataset), section);
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
