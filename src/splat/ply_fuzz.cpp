// libFuzzer's entry to scenes: the PLY, and the JSON beside it, told apart by their first bytes.
#include "core/file.h"
#include "core/fuzz.h"
#include "splat/ply.h"
#include "splat/scene_file.h"
#include "splat/test_scene.h"

namespace clipgs::fuzz {

std::vector<Bytes> seeds() {
  Scene scene = layered_scene(8, 1, 1);
  scene.gaussians = random_faces(8, 1, 1);
  write_scene(scratch_folder() / "scene.ply", scene);
  write_ply(scratch_folder() / "plain.ply", random_gaussians(8, 3, 1));
  std::vector<Bytes> result;
  for (const char* name : {"scene.ply", "scene.json", "plain.ply"}) {
    result.push_back(read_file(scratch_folder() / name));
  }
  return result;
}

void read(std::span<const std::uint8_t> input) {
  if (input.size() > 3 && text_of(input.first(3)) == "ply") {
    PlyColumns columns{{"layer", {}}};
    read_ply(input, "input.ply", &columns);
  } else {
    as_file(input, "scene.json");
    read_scene(scratch_folder() / "scene.ply");
  }
}

}  // namespace clipgs::fuzz
