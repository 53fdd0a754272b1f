// libFuzzer's entry to everything that reads a case or a PLY:
//   cmake -B build/fuzz -DCMAKE_CXX_COMPILER=clang++-19 -DCLIPGS_FUZZ=ON -DCLIPGS_WERROR=OFF
//         -DCLIPGS_SANITIZE=address,undefined,fuzzer-no-link
//   cmake --build build/fuzz --target case_fuzz && build/fuzz/src/asset/case_fuzz
#include <cstddef>
#include <cstdint>
#include <span>

#include "asset/case.h"
#include "core/error.h"
#include "section/test_section.h"
#include "splat/ply.h"
#include "splat/test_scene.h"

namespace {

using clipgs::Bytes;
using clipgs::ZipEntry;

/// A valid case with entry `which` replaced, under checksums that hold: past the archive's own
/// checks, which a mutation hardly ever survives.
Bytes case_with(std::span<const std::uint8_t> content, size_t which) {
  static const auto kEntries = [] {
    clipgs::Scene scene = clipgs::layered_scene(40, 1, 1);
    scene.gaussians = clipgs::random_faces(40, 1, 1);
    return clipgs::read_zip(
        clipgs::encode_case({std::move(scene), clipgs::test::ball_section()}, nullptr), "seed");
  }();
  std::vector<ZipEntry> entries;
  for (const auto& [name, bytes] : kEntries) {
    const bool replaced = entries.size() == which % kEntries.size();
    entries.push_back({name, replaced ? Bytes(content.begin(), content.end()) : bytes});
  }
  return clipgs::write_zip(entries);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, size_t size) {
  if (size < 1) {
    return 0;
  }
  const std::span<const std::uint8_t> content(data + 1, size - 1);
  try {
    switch (data[0] % 3) {
      case 0:
        clipgs::read_case(content, "fuzz.sog");
        break;
      case 1:
        clipgs::read_ply(content, "fuzz.ply");
        break;
      default:
        clipgs::read_case(case_with(content, data[0] / 3), "fuzz.sog");
    }
  } catch (const clipgs::Error&) {
    return 0;
  }
  return 0;
}
