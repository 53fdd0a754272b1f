#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/ranges.h>
#include <string>
#include <vector>

#include "cinema/scene.h"
#include "cli/arguments.h"
#include "core/body_part.h"
#include "volume/load.h"
#include "volume/metal.h"

namespace clipgs {

/// --crop: "matter", or "r0,r1,a0,a1,s0,s1" in RAS mm.
inline void parse_crop(const std::string& text, PrepareOptions& options) {
  options.crop_to_matter = text == "matter";
  options.crop.reset();
  if (!options.crop_to_matter) {
    const std::vector<float> n = parse_numbers(text, 6, 6, "--crop");
    options.crop = Box{{n[0], n[2], n[4]}, {n[1], n[3], n[5]}};
  }
}

/// --soften-metal: "auto", or HU.
inline void parse_metal(const std::string& text, PrepareOptions& options) {
  options.metal =
      text == "auto" ? kMetal : parse_numbers(text, 1, 1, "--soften-metal", {500, 1e5f})[0];
}

/// --denoise-volume: "auto", or a standard deviation in value units.
inline void parse_noise(const std::string& text, PrepareOptions& options) {
  options.noise =
      text == "auto" ? 0 : parse_numbers(text, 1, 1, "--denoise-volume", {1e-3f, 1e9f})[0];
}

/// Adds what makes a volume ready to be traced.
inline void add_prepare_options(CLI::App& command, PrepareOptions& options) {
  command
      .add_option_function<std::string>(
          "--crop", [&options](const std::string& text) { parse_crop(text, options); },
          "Leave a box of the volume, from and to mm R, A and S, or what lies around matter")
      ->type_name("R0,R1,A0,A1,S0,S1|matter");
  command
      .add_option_function<std::string>(
          "--soften-metal", [&options](const std::string& text) { parse_metal(text, options); },
          "Soften the streaks of metal, of this many HU or more, in a CT's axial slices (auto: "
          "2500)")
      ->type_name("HU|auto");
  command.add_flag("--bias", options.bias,
                   "Even out how the signal of MR falls off with the distance from its coils");
  command
      .add_option_function<std::string>(
          "--denoise-volume", [&options](const std::string& text) { parse_noise(text, options); },
          "Average noise of this standard deviation (HU of CT) out of the values, not across edges")
      ->type_name("SIGMA|auto");
}

/// Adds --region. `part` must outlive the parsing.
inline void add_region_option(CLI::App& command, BodyPart& part) {
  command
      .add_option_function<std::string>(
          "--region",
          [&part](const std::string& word) {
            const std::optional<BodyPart> known = body_part_of_term(word);
            if (!known) {
              throw CLI::ValidationError(
                  "--region", fmt::format("\"{}\" is no region of the body; give one of {}", word,
                                          body_part_words()));
            }
            part = *known;
          },
          "What it shows of the body, for the case to say, instead of what a DICOM header or a CT "
          "itself tells: " +
              body_part_words())
      ->type_name("WORD");
}

inline constexpr const char* kVolumeOptions[] = {
    "--series",     "--frame",  "--gaps", "--hu",           "--modality", "--region",
    "--keep-table", "--deface", "--crop", "--soften-metal", "--bias",     "--denoise-volume"};

/// Adds VOLUME, the path of what is read.
inline void add_volume_argument(CLI::App& command, std::filesystem::path& volume) {
  command
      .add_option("VOLUME", volume,
                  "Volume: DICOM (folder, file or .zip), NIfTI, NRRD or MetaImage")
      ->required();
}

/// Adds kVolumeOptions, which every command that reads a volume understands. `options` must outlive
/// the parsing.
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
  add_region_option(command, options.part);
  command.add_flag("--keep-table", options.keep_table,
                   "Leave the scanner's table and cushions in a CT's pictures");
  command.add_flag("--deface", options.deface,
                   "Take face and ears off a head, in CT and MR, and nothing near the brain");
  add_prepare_options(command, options.prepare);
}

/// Those of them that were given, word by word as another command takes them. Call after parsing.
inline std::vector<std::string> given_volume_options(const CLI::App& command) {
  std::vector<std::string> words;
  for (const char* const name : kVolumeOptions) {
    const CLI::Option* const option = command.get_option(name);
    if (option->count() == 0) {
      continue;
    }
    words.emplace_back(name);
    if (option->get_items_expected_max() > 0) {
      words.push_back(fmt::format("{}", fmt::join(option->results(), ",")));
    }
  }
  return words;
}

}  // namespace clipgs
