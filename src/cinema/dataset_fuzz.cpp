// libFuzzer's entry to a dataset's own files: transforms.json and points.ply, told apart by their
// first bytes; and to cameras.
#include "cinema/dataset.h"
#include "cinema/make_dataset.h"
#include "core/camera_file.h"
#include "core/file.h"
#include "core/fuzz.h"
#include "volume/phantom.h"

namespace clipgs::fuzz {

std::vector<Bytes> seeds() {
  DatasetOptions options;
  options.size = 16;
  options.upsample = false;
  options.train_frames = 3;
  options.test_frames = 1;
  options.validation_frames = 1;
  options.train_spp = 2;
  options.test_noise_db = 10;
  options.test_masked_noise_db = 0;
  options.seed_points = 20;
  const auto folder = scratch_folder() / "dataset";
  make_dataset(make_ball(16, 6, 300, -1000), load_preset("soft-tissue"), folder, options);
  const Bytes camera =
      bytes_of(R"({"w": 8, "h": 6, "fl_x": 9, "fl_y": 9, "cx": 4, "cy": 3, "transform_matrix":)"
               " [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 5], [0, 0, 0, 1]]}");
  return {read_file(folder / "transforms.json"), read_file(folder / "points.ply"), camera};
}

void read(std::span<const std::uint8_t> input) {
  const auto folder = scratch_folder() / "dataset";
  if (text_of(input.first(std::min<size_t>(input.size(), 3))) == "ply") {
    as_file(input, "dataset/points.ply");
    load_seed_points(folder);
  } else if (text_of(input).find("\"frames\"") == std::string::npos) {
    read_camera(as_file(input, "camera.json"));
  } else {
    as_file(input, "dataset/transforms.json");
    load_dataset(folder);
  }
}

}  // namespace clipgs::fuzz
