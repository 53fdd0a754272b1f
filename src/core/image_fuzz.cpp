// libFuzzer's entry to the readers of pictures: PNG, Radiance HDR and PFM.
#include "core/file.h"
#include "core/fuzz.h"
#include "core/image.h"

namespace clipgs::fuzz {

std::vector<Bytes> seeds() {
  std::vector<Bytes> result;
  for (const int channels : {1, 3, 4}) {
    for (const int bits : {8, 16}) {
      Image image(5, 3, channels);
      for (size_t i = 0; i < image.data.size(); ++i) {
        image.data[i] = static_cast<float>(i % 7) / 6.0f;
      }
      const auto path = scratch_folder() / "seed.png";
      write_png(path, image, bits);
      result.push_back(read_file(path));
    }
  }
  // Two rows of eight pixels: one as the format's run-length code has it, one plain.
  std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n";
  result.push_back(
      bytes_of(hdr + std::string("\x02\x02\x00\x08", 4) + "\x88\x50\x88\x60\x88\x70\x88\x81"));
  result.push_back(
      bytes_of("#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\nabc\x80"
               "def\x81"));
  result.push_back(bytes_of("PF\n2 1\n-1.0\n0123456789abcdefghijklmn"));
  result.push_back(bytes_of("Pf\n1 2\n1.0\n01234567"));
  return result;
}

void read(std::span<const std::uint8_t> input) {
  if (!input.empty() && input[0] == '#') {
    read_hdr(as_file(input, "input.hdr"));
  } else if (!input.empty() && input[0] == 'P') {
    read_pfm(as_file(input, "input.pfm"));
  } else {
    read_png(as_file(input, "input.png"));
  }
}

}  // namespace clipgs::fuzz
