#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "core/file.h"
#include "volume/load.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

struct PhantomOptions {
  std::filesystem::path out;
  int size = 256;
  std::uint64_t seed = 1;
};

void run_phantom(const PhantomOptions& options) {
  require_writable(options.out);
  const Volume volume = make_phantom(options.size, options.seed);
  save_volume(options.out, volume);
  fmt::print("{}: {} x {} x {} voxels of {:.2f} mm\n", options.out.string(), volume.dims.x,
             volume.dims.y, volume.dims.z, volume.spacing.x);
}

}  // namespace

void add_phantom_command(CLI::App& app) {
  auto options = std::make_shared<PhantomOptions>();
  CLI::App* command = app.add_subcommand("phantom", "Write a procedural anatomical torso in HU");
  command->footer("Example: clipgs phantom torso.nii.gz --size 256");
  command->add_option("OUT", options->out, "File to write: .nii.gz, .nii, .nrrd or .mha")
      ->required()
      ->check(ends_in({".nii.gz", ".nii", ".nrrd", ".mha"}));
  command->add_option("--size", options->size, "Voxels along the longest axis")
      ->check(CLI::Range(16, 1024))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the texture and the small variations")
      ->capture_default_str();
  command->callback([options] { run_phantom(*options); });
}

}  // namespace clipgs
