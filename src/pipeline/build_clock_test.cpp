#include "pipeline/build_clock.h"

#include <gtest/gtest.h>

namespace clipgs {
namespace {

BuildOptions some_options() {
  BuildOptions options;
  options.pictures.size = 256;
  options.pictures.train_frames = 2000;
  options.pictures.train_spp = 10;
  options.training.steps = 8000;
  return options;
}

TEST(BuildClock, TellsNothingBeforeThereIsAnythingToTellBy) {
  BuildClock clock(some_options());
  EXPECT_FALSE(clock.left(0));
  clock.update("reading", 0.5, 1);
  EXPECT_FALSE(clock.left(1));
  clock.update("dataset", 0, 2);
  EXPECT_FALSE(clock.left(2));
}

TEST(BuildClock, LearnsHowFastTheMachineIs) {
  BuildClock fast(some_options());
  BuildClock slow(some_options());
  for (int i = 0; i <= 10; ++i) {
    fast.update("dataset", 0.05 * i, 5 * i);
    slow.update("dataset", 0.05 * i, 10 * i);
  }
  ASSERT_TRUE(fast.left(50) && slow.left(100));
  EXPECT_GT(*fast.left(50), 50);  // half of the pictures, and all of the training
  EXPECT_NEAR(*slow.left(100), 2 * *fast.left(50), 1e-6);
  EXPECT_NEAR(*fast.left(53), *fast.left(50) - 3, 1e-6);
}

TEST(BuildClock, IsRightAtTheEnd) {
  BuildClock clock(some_options());
  double now = 0;
  for (const char* label : {"dataset", "loading", "training"}) {
    for (int i = 0; i <= 100; ++i) {
      clock.update(label, 0.01 * i, now += 1);
    }
  }
  EXPECT_EQ(clock.left(now), 0);
}

TEST(BuildClock, DoesNotCountWhatWasThereAlready) {
  BuildClock whole(some_options());
  BuildClock resumed(some_options());
  whole.update("training", 0, 0);
  whole.update("training", 0.5, 100);
  resumed.update("training", 0.5, 0);
  resumed.update("training", 0.75, 50);
  EXPECT_NEAR(*whole.left(100), 100, 1e-6);
  EXPECT_NEAR(*resumed.left(50), 50, 1e-6);
}

}  // namespace
}  // namespace clipgs
