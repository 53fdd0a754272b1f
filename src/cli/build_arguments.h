#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/build_case.h"

#include "cli/archive_options.h"
#include "cli/look_options.h"

namespace clipgs {

/// Numbers of the quality that the user wants otherwise; 0 or −1: as the quality says.
struct Overrides {
  int size = 0;
  int train_frames = 0;
  int test_frames = 0;
  size_t budget = 0;
  size_t steps = 0;
  int sh_degree = -1;
};

/// What a command that builds cases is told.
struct BuildArguments {
  std::string volume;
  ArchiveArguments archive;  ///< where the volume is an address
  std::string output;
  LookArguments look;
  std::string quality = "standard";
  std::string model = "explicit";
  std::string work;
  std::string title;
  std::uint64_t seed = 1;
  LoadOptions loading;
  SectionChoice section;
  bool denoise = false;
  Overrides overrides;
  DatasetOptions tests;  ///< what add_test_picture_options() sets

  /// Of a case that is there at once nothing is traced and nothing trained.
  bool instant() const { return quality == "instant"; }
};

/// Adds --preset and the other options of the look, --quality, --title, --seed, and those of the
/// section and of reading the volume. `arguments` must outlive the parsing.
void add_build_options(CLI::App& command, BuildArguments& arguments);

/// Where work in progress is kept: --work, or else beside the output.
std::filesystem::path work_folder(const BuildArguments& arguments);

/// Throws CLI::ValidationError for a quality that there is not.
BuildOptions build_options(const BuildArguments& arguments);

/// Throws Error if there is no such volume.
void require_volume(const BuildArguments& arguments);

/// A build for each of the presets that --preset names with commas between them: of several,
/// OUTPUT-PRESET.sog and a work folder of its own. Throws CLI::ValidationError.
std::vector<BuildArguments> builds_of_looks(const BuildArguments& arguments);

/// Before the first of `builds`, all of one volume, takes its time: the last can be built, too.
/// Throws Error.
void require_looks(const std::vector<BuildArguments>& builds);

}  // namespace clipgs
