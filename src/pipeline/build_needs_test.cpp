#include "pipeline/build_needs.h"

#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cinema/scene.h"

namespace clipgs {
namespace {

VolumeSize cube(int side) { return {.dims = IVec3(side), .stored_bytes = 2, .spacing = Vec3(1)}; }

BuildOptions draft() {
  BuildOptions options;
  options.pictures.size = 192;
  options.pictures.train_frames = 600;
  options.pictures.test_frames = 2;
  options.pictures.train_spp = 4;
  options.training.budget = 40000;
  options.training.steps = 2000;
  return options;
}

StepNeeds find(const std::vector<StepNeeds>& steps, std::string_view name) {
  return *std::ranges::find(steps, name, &StepNeeds::step);
}

std::vector<std::string> names(const std::vector<StepNeeds>& steps) {
  std::vector<std::string> list;
  for (const StepNeeds& needs : steps) {
    list.emplace_back(needs.step);
  }
  return list;
}

TEST(BuildNeeds, AreThoseOfTheStepsOfEitherWay) {
  BuildOptions options = draft();
  EXPECT_THAT(names(build_needs(cube(128), options)),
              testing::ElementsAre("dataset", "train", "pack", "eval"));
  options.papers_way = true;
  EXPECT_THAT(names(build_needs(cube(128), options)),
              testing::ElementsAre("dataset", "train", "refine", "pack", "eval"));
  EXPECT_THAT(names(instant_needs(cube(128), {}, true)), testing::ElementsAre("build"));
}

TEST(BuildNeeds, PicturesNeedWhatLoadingIsRefusedWithout) {
  const BuildOptions options = draft();
  for (const int side : {64, 256, 1024}) {
    const VolumeSize size = cube(side);
    const std::uint64_t memory = find(build_needs(size, options), "dataset").memory;
    const std::uint64_t work = dataset_memory(size, options.section, true);
    EXPECT_TRUE(lack_of_memory(size, work, memory).empty());
    EXPECT_LT(memory, 1.1 * static_cast<double>(size.loaded() + work) + 1e8);
  }
}

TEST(BuildNeeds, GrowWithTheVolumeAndTheWork) {
  const BuildOptions options = draft();
  const std::vector<StepNeeds> small = build_needs(cube(64), options);
  const std::vector<StepNeeds> large = build_needs(cube(512), options);
  for (size_t i = 0; i < small.size(); ++i) {
    EXPECT_GT(large[i].memory, small[i].memory) << small[i].step;
  }
  EXPECT_GT(find(large, "dataset").seconds, find(small, "dataset").seconds);

  BuildOptions more = options;
  more.training.steps *= 3;
  more.pictures.train_frames *= 4;
  const std::vector<StepNeeds> longer = build_needs(cube(64), more);
  EXPECT_GT(find(longer, "train").seconds, 2 * find(small, "train").seconds);
  EXPECT_GT(find(longer, "dataset").seconds, find(small, "dataset").seconds);
  EXPECT_GT(find(longer, "train").memory, find(small, "train").memory);
  EXPECT_EQ(find(longer, "pack").memory, find(small, "pack").memory);
}

TEST(BuildNeeds, OfTheLargestVolumeTheDatasetTakesMost) {
  const std::vector<StepNeeds> steps = build_needs(cube(1024), draft());
  EXPECT_GT(steps.front().memory, 5'000'000'000U);  // docs/volumes.md
  for (size_t i = 1; i < steps.size(); ++i) {
    EXPECT_LT(steps[i].memory, 1'500'000'000U) << steps[i].step;
  }
}

}  // namespace
}  // namespace clipgs
