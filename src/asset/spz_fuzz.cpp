// libFuzzer's entry to SPZ files, of the packed versions and, by their first byte, of those in
// gzip.
#include "asset/spz.h"
#include "core/fuzz.h"
#include "splat/test_scene.h"

namespace clipgs::fuzz {

std::vector<Bytes> seeds() {
  return {encode_spz(random_gaussians(8, 0, 1)),
          encode_spz(random_gaussians(8, 3, 1)),
          {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3}};
}

void read(std::span<const std::uint8_t> input) { decode_spz(input, "fuzz.spz"); }

}  // namespace clipgs::fuzz
