// libFuzzer's entry to a case: the file as it is, or, where the first byte says so, one entry of it
// under checksums that hold, past the archive's own checks, which a mutation hardly ever survives.
#include <algorithm>

#include "asset/case.h"
#include "asset/zip.h"
#include "core/error.h"
#include "core/fuzz.h"
#include "section/test_section.h"
#include "splat/test_scene.h"

namespace clipgs::fuzz {

namespace {

const Bytes& seed_case() {
  static const Bytes kCase = [] {
    Scene scene = layered_scene(40, 1, 1);
    scene.gaussians = random_faces(40, 1, 1);
    // Its section is a video.
    return encode_case({std::move(scene), test::ball_section()}, nullptr, {.section_quality = 90});
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

/// As the server's index does: its own reader of ZIPs, in parts.
void read_summary(std::span<const std::uint8_t> bytes) {
  const ByteSource source{bytes.size(), [&](std::uint64_t offset, std::span<std::uint8_t> out) {
                            const auto rest = bytes.subspan(std::min<size_t>(offset, bytes.size()));
                            const size_t size = std::min(rest.size(), out.size());
                            std::copy_n(rest.begin(), size, out.begin());
                            return size;
                          }};
  try {
    read_case_summary(source, "fuzz.sog");
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): the whole case is read all the same
  }
}

void read_whole(std::span<const std::uint8_t> bytes) {
  read_summary(bytes);
  read_case(bytes, "fuzz.sog");
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
    read_whole(case_with(input.subspan(1), input[0]));
  } else {
    read_whole(input);
  }
}

}  // namespace clipgs::fuzz
