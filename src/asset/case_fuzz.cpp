// libFuzzer's entry to a case: the file as it is, or, where the first byte says so, one entry of it
// under checksums that hold, past the archive's own checks, which a mutation hardly ever survives.
#include "asset/case.h"
#include "asset/zip.h"
#include "core/fuzz.h"
#include "section/test_section.h"
#include "splat/test_scene.h"

namespace clipgs::fuzz {

namespace {

const Bytes& seed_case() {
  static const Bytes kCase = [] {
    Scene scene = layered_scene(40, 1, 1);
    scene.gaussians = random_faces(40, 1, 1);
    return encode_case({std::move(scene), test::ball_section()}, nullptr);
  }();
  return kCase;
}

const auto& seed_entries() {
  static const auto kEntries = read_zip(seed_case(), "seed");
  return kEntries;
}

Bytes case_with(std::span<const std::uint8_t> content, size_t which) {
  std::vector<ZipEntry> entries;
  for (const auto& [name, bytes] : seed_entries()) {
    const bool replaced = entries.size() == which % seed_entries().size();
    entries.push_back({name, replaced ? Bytes(content.begin(), content.end()) : bytes});
  }
  return write_zip(entries);
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> result{seed_case()};
  std::uint8_t which = 0;
  for (const auto& [name, bytes] : seed_entries()) {
    result.push_back({which++});
    result.back().insert(result.back().end(), bytes.begin(), bytes.end());
  }
  return result;
}

void read(std::span<const std::uint8_t> input) {
  if (input.empty()) {
    return;
  }
  if (input[0] < seed_entries().size()) {
    read_case(case_with(input.subspan(1), input[0]), "fuzz.sog");
  } else {
    read_case(input, "fuzz.sog");
  }
}

}  // namespace clipgs::fuzz
