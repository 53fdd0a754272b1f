// libFuzzer's entry to volumes in files: NIfTI, NRRD or MetaImage, whichever CLIPGS_FUZZ_FORMAT is.
#include <string_view>

#include "core/file.h"
#include "core/fuzz.h"
#include "volume/load.h"
#include "volume/phantom.h"

namespace clipgs::fuzz {

namespace {

constexpr std::string_view kFormat = CLIPGS_FUZZ_FORMAT;

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<std::string> names{"seed" + std::string(kFormat)};
  if (kFormat == ".nii") {
    names.emplace_back("seed.nii.gz");
  }
  const Volume volume = make_ball(6, 2, 40, -1000);
  std::vector<Bytes> result;
  for (const std::string& name : names) {
    save_volume(scratch_folder() / name, volume);
    result.push_back(read_file(scratch_folder() / name));
  }
  return result;
}

void read(std::span<const std::uint8_t> input) {
  const bool gzip = kFormat == ".nii" && input.size() > 2 && input[0] == 0x1f && input[1] == 0x8b;
  load_volume(as_file(input, "input" + std::string(kFormat) + (gzip ? ".gz" : "")));
}

}  // namespace clipgs::fuzz
