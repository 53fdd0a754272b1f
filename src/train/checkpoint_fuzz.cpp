// libFuzzer's entry to a trainer's checkpoint, and to the first step after it.
#include "cinema/make_dataset.h"
#include "core/file.h"
#include "core/fuzz.h"
#include "train/trainer.h"
#include "volume/phantom.h"

namespace clipgs::fuzz {

namespace {

TrainOptions options() {
  TrainOptions result;
  result.budget = 30;
  result.start = 20;
  result.steps = 40;
  result.sh_degree = 0;
  result.relocate_every = 10;
  return result;
}

Trainer& trainer() {
  static const Dataset kDataset = [] {
    DatasetOptions options;
    options.size = 16;
    options.train_frames = 2;
    options.test_frames = 1;
    options.validation_frames = 1;
    options.train_spp = 2;
    options.test_noise_db = 10;
    options.test_masked_noise_db = 0;
    options.upsample = false;
    options.seed_points = 40;
    return make_dataset(make_ball(16, 6, 300, -1000), load_preset("soft-tissue"),
                        scratch_folder() / "dataset", options);
  }();
  static Trainer result(kDataset, options());
  return result;
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> result;
  for (const int steps : {1, 14, 20}) {
    for (int i = 0; i < steps; ++i) {
      trainer().step();
    }
    trainer().save_checkpoint(scratch_folder() / "seed.checkpoint");
    result.push_back(read_file(scratch_folder() / "seed.checkpoint"));
  }
  return result;
}

void read(std::span<const std::uint8_t> input) {
  if (trainer().load_checkpoint(as_file(input, "input.checkpoint"))) {
    trainer().step();
  }
}

}  // namespace clipgs::fuzz
