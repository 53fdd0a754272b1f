#pragma once

#include <CLI/CLI.hpp>

#include "cinema/scene.h"
#include "volume/load.h"

namespace clipgs {

/// Adds --series, --frame, --gaps, --hu, --modality and --keep-table, which every command that
/// reads a volume understands. `options` must outlive the parsing.
inline void add_volume_options(CLI::App& command, LoadOptions& options) {
  options.work = [](const VolumeSize& size) { return picture_memory(size, true); };
  command.add_option("--series", options.series,
                     "DICOM series or phase, by its number in the list of clipgs info, or by UID "
                     "(default: the largest; of phases alike in size the first)");
  command.add_option("--frame", options.frame, "Volume of a 4D file (a series in time), from 1")
      ->check(CLI::PositiveNumber);
  command
      .add_option_function<std::string>(
          "--gaps",
          [&options](const std::string& word) {
            options.gaps = word == "refuse" ? Gaps::kRefuse : Gaps::kInterpolate;
          },
          "Where a few slices of a series are missing (at most 3 in a row and 10 % of all)")
      ->check(CLI::IsMember({"interpolate", "refuse"}))
      ->default_str("interpolate");
  command
      .add_option_function<std::vector<float>>(
          "--hu",
          [&options](const std::vector<float>& values) {
            options.hu = Rescale{values[0], values[1]};
          },
          "HU = SCALE * stored + OFFSET, for data that does not say so, e.g. --hu 16,-1024")
      ->type_name("SCALE,OFFSET")
      ->delimiter(',')
      ->expected(2);
  command
      .add_option_function<std::string>(
          "--modality",
          [&options](const std::string& word) {
            options.modality = modality_of_word(word).value_or(Modality::kUnknown);
          },
          "What made the pictures, instead of what is guessed: ct, mr, pet, us (ultrasound) or "
          "photo, e.g. --modality mr")
      ->check(CLI::IsMember({"ct", "mr", "pet", "us", "photo"}));
  command.add_flag("--keep-table", options.keep_table,
                   "Leave the scanner's table and cushions in a CT's pictures");
}

}  // namespace clipgs
