#include "cli/section_options.h"

namespace clipgs {

void add_section_options(CLI::App& command, SectionChoice& choice) {
  command
      .add_option("--section-size", choice.size,
                  "Side of a cube of as many voxels as the section, the volume that cut faces are "
                  "drawn from, may have")
      ->check(CLI::Range(8, 1024))
      ->capture_default_str();
  command.add_flag("--no-section", choice.none,
                   "No section: splats fill the cut faces (always so with --labels)");
}

void add_section_coding(CLI::App& command, SectionChoice& choice) {
  command
      .add_option("--section-quality", choice.coding.section_quality,
                  "Of the section's voxels in the case: 100 is lossless (default: 97, or the best "
                  "that --max-mb leaves room for, 70 at least; small ones lossless)")
      ->check(CLI::Range(1.0, 100.0));
  command
      .add_option_function<double>(
          "--max-mb", [&choice](double mb) { choice.coding.bytes = static_cast<size_t>(1e6 * mb); },
          "What the case should take at most, MB; less loses more of the section and of the "
          "splats' colours (default 5)")
      ->check(CLI::Range(0.0, 1000.0));
}

}  // namespace clipgs
