// What a section loses and takes by each quality, as one image and as a video: section_bench
// NAME.section.zip... (of a work folder). Prints a row of docs/benchmarks.md a quality.
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

#include "asset/section_file.h"
#include "asset/section_slices.h"
#include "core/error.h"

namespace clipgs {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Rms of what codes miss, where there is no air around the body.
double rms_inside(const Section& section, const std::vector<std::uint8_t>& read_back) {
  double squares = 0;
  size_t count = 0;
  for (size_t i = 0; i < read_back.size(); ++i) {
    if (section.voxels[i] >= Section::kFirstInside) {
      squares += std::pow(static_cast<double>(read_back[i]) - section.voxels[i], 2);
      ++count;
    }
  }
  return std::sqrt(squares / static_cast<double>(std::max<size_t>(1, count)));
}

/// "MB, rms, seconds to code, seconds to decode".
std::string measured(const Section& section, const CodedSlices& coded, double coding) {
  const nlohmann::json keys = coded.keys;
  const JsonReader reader(keys, "coded");
  const Clock::time_point begin = Clock::now();
  decode_slices(reader, coded.file.bytes, section.dims, section.channels, "coded");
  return fmt::format("{:.2f} | {:.2f} | {:.1f} | {:.1f}",
                     1e-6 * static_cast<double>(coded.file.bytes.size()),
                     rms_inside(section, coded.voxels), coding, seconds_since(begin));
}

void compare(const std::filesystem::path& path) {
  const Section section = read_section(path);
  for (const float quality : {97.0f, 94.0f, 90.0f, 80.0f, 70.0f}) {
    Clock::time_point begin = Clock::now();
    const CodedSlices image = as_image(section, quality, Saving::kBytes);
    const std::string as_image_row = measured(section, image, seconds_since(begin));
    begin = Clock::now();
    const CodedSlices video = as_video(section, quality);
    fmt::print("| {} | {} | {} | {:.0f} % |\n", quality, as_image_row,
               measured(section, video, seconds_since(begin)),
               100 * static_cast<double>(video.file.bytes.size()) /
                   static_cast<double>(image.file.bytes.size()));
  }
}

}  // namespace
}  // namespace clipgs

int main(int argc, char** argv) {
  try {
    for (int i = 1; i < argc; ++i) {
      fmt::print("{}\n", argv[i]);
      clipgs::compare(argv[i]);
    }
  } catch (const clipgs::Error& error) {
    fmt::print(stderr, "section_bench: {}\n", error.what());
    return 1;
  }
}
