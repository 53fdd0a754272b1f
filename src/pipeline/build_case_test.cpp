#include "pipeline/build_case.h"

#include <fmt/format.h>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "core/progress.h"
#include "volume/phantom.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;

/// A build small enough for a test, but with every step of a real one.
struct Input {
  Volume volume = make_ball(24, 9, 300, -1000);
  Preset preset = load_preset("soft-tissue");
  BuildOptions options;

  Input() {
    DatasetOptions& pictures = options.pictures;
    pictures.size = 32;
    pictures.train_frames = 6;
    pictures.test_frames = 1;
    pictures.validation_frames = 1;
    pictures.train_spp = 2;
    pictures.test_noise_db = 20;
    pictures.test_masked_noise_db = 0;
    pictures.seed_points = 500;
    options.section.size = 8;
    options.training.budget = options.training.start = 300;
    options.training.steps = 20;
  }
};

class BuildCaseTest : public testing::Test {
 protected:
  BuildCaseTest()
      : folder_(fs::path(testing::TempDir()) / fmt::format("clipgs-build-{}", getpid())) {
    fs::create_directories(folder_);
    Progress::set_enabled(false);
  }
  ~BuildCaseTest() override { fs::remove_all(folder_); }

  /// What the case would show; said_ is what the steps said of what was there before.
  std::vector<float> build(const Input& input, const std::string& work = "work") {
    testing::internal::CaptureStderr();
    const Case contents =
        build_contents(input.volume, input.preset, input.options, FolderLock(folder_ / work));
    said_ = testing::internal::GetCapturedStderr();
    shown_ = contents.scene.gaussians.data();
    look_ = contents.scene.look;
    if (contents.section) {
      shown_.insert(shown_.end(), contents.section->voxels.begin(), contents.section->voxels.end());
    }
    return shown_;
  }

  /// Changes the input: these steps alone are made again, for this reason.
  void expect_again(const std::string& what, const std::function<void(Input&)>& change,
                    const std::vector<std::string>& expected) {
    SCOPED_TRACE(what);
    change(input_);
    build(input_);
    std::vector<std::string> again;
    for (size_t at = 0; (at = said_.find(": made again, ", at)) != std::string::npos; ++at) {
      const size_t begin = said_.rfind('\n', at) + 1;
      again.push_back(said_.substr(begin, said_.find('\n', at) - begin));
    }
    EXPECT_EQ(again, expected) << said_;
  }
  /// After all changes the case is the one of a build from scratch.
  void expect_as_from_scratch() {
    const std::vector<float> changed = shown_;
    EXPECT_TRUE(build(input_, "fresh") == changed);
    EXPECT_THAT(said_, Not(AnyOf(HasSubstr("again"), HasSubstr("before"))));
  }

  fs::path folder_;
  std::string said_;
  std::vector<float> shown_;
  VolumeLook look_;
  Input input_;
};

std::vector<std::string> lines(const std::string& cause) {
  return {fmt::format("seed points: made again, the {} changed", cause),
          fmt::format("pictures: made again, the {} changed", cause),
          "section: made again, the pictures changed",
          "training: made again, the pictures, the section and the seed points changed"};
}

TEST_F(BuildCaseTest, WhatDependsOnAChangeIsMadeAgainAndNothingElse) {
  build(input_);
  EXPECT_THAT(said_, Not(AnyOf(HasSubstr("again"), HasSubstr("before"))));
  build(input_);
  for (const char* step : {"pictures", "seed points", "section", "training"}) {
    EXPECT_THAT(said_, HasSubstr(fmt::format("{}: done before", step)));
  }
  expect_again("title", [](Input& i) { i.options.title = "Ball"; }, {});
  expect_again("region", [](Input& i) { i.volume.part = BodyPart::kKnee; }, {});
  EXPECT_EQ(look_.part, BodyPart::kKnee);
  EXPECT_EQ(load_dataset(folder_ / "work" / "dataset").look, look_);
  expect_again("steps", [](Input& i) { i.options.training.steps = 21; },
               {"training: made again, the steps changed"});
  expect_again("budget",
               [](Input& i) { i.options.training.budget = i.options.training.start = 290; },
               {"training: made again, the budget and the number at the start changed"});
  expect_again("budget above the points", [](Input& i) { i.options.training.budget = 600; },
               {"seed points: made again, the number of points changed",
                "training: made again, the budget and the seed points changed"});
  expect_again(
      "section", [](Input& i) { i.options.section.size = 9; },
      {"section: made again, the size changed", "training: made again, the section changed"});
  expect_again(
      "size", [](Input& i) { i.options.pictures.size = 33; },
      {"pictures: made again, the size changed", "section: made again, the pictures changed",
       "training: made again, the pictures and the section changed"});
  expect_again("no section", [](Input& i) { i.options.section.none = true; },
               {"pictures: made again, the choice of views and the share of near views changed",
                "training: made again, the pictures and the section changed"});
  expect_as_from_scratch();
}

TEST_F(BuildCaseTest, EachCaseThatIsShownMeanwhileHasLearntMore) {
  std::vector<Case> seen;
  const auto build_and_see = [&] {
    seen.clear();
    return build_contents(input_.volume, input_.preset, input_.options,
                          FolderLock(folder_ / "work"),
                          [&](Case contents) { seen.push_back(std::move(contents)); });
  };
  input_.options.title = "Ball";
  input_.options.section.size = 48;  // so fine that nearly all of its matter is opaque
  input_.volume = make_ball(48, 19, 300, -1000);
  const Case finished = build_and_see();
  std::vector<float> trained;
  for (const Case& contents : seen) {
    trained.push_back(contents.scene.trained);
    EXPECT_EQ(contents.scene.title, "Ball");
    EXPECT_EQ(contents.section->voxels, finished.section->voxels);
  }
  EXPECT_THAT(trained, testing::ElementsAre(0, 0.25f, 0.5f));
  EXPECT_TRUE(seen.front().scene.placed);
  EXPECT_FALSE(seen.back().scene.placed);
  EXPECT_EQ(finished.scene.trained, 1);
  build_and_see();
  EXPECT_TRUE(seen.empty());
  input_.options.training.steps = 24;
  build_and_see();
  EXPECT_EQ(seen.size(), 2);  // what the section shows is the same
  EXPECT_EQ(build(input_, "fresh"), (build(input_), shown_)) << "who looks on changes nothing";
}

TEST_F(BuildCaseTest, AVersionThatCannotBeWrittenEndsTheBuildWhichThenGoesOn) {
  input_.options.section.size = 48;
  input_.volume = make_ball(48, 19, 300, -1000);
  const fs::path output = folder_ / "cases" / "ball.sog";
  const auto build_file = [&] {
    fs::create_directories(output.parent_path());
    build_case(input_.volume, input_.preset, input_.options, FolderLock(folder_ / "work"), output);
  };
  // While pictures are traced the folder goes away: every version after that is lost.
  Progress::set_watcher([&](const std::string& label, double) {
    if (label == "dataset") {
      fs::remove_all(output.parent_path());
    }
  });
  EXPECT_THROW(build_file(), Error);
  Progress::set_watcher(nullptr);
  testing::internal::CaptureStderr();
  build_file();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("pictures: done before"));
  EXPECT_EQ(read_case_info(output).scene.trained, 1);
}

TEST_F(BuildCaseTest, AFinishedCaseIsWrittenAgainOnlyWhereItIsAnother) {
  const fs::path output = folder_ / "ball.sog";
  const auto build_file = [&] {
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    build_case(input_.volume, input_.preset, input_.options, FolderLock(folder_ / "work"), output);
    testing::internal::GetCapturedStderr();
    return testing::internal::GetCapturedStdout().find("ball.sog") != std::string::npos;
  };
  EXPECT_TRUE(build_file());
  EXPECT_FALSE(build_file());
  input_.options.title = "Ball";
  EXPECT_TRUE(build_file());
  EXPECT_EQ(read_case_info(output).scene.title, "Ball");
  EXPECT_FALSE(build_file());
  write_text(output, "something else");
  EXPECT_TRUE(build_file());
  EXPECT_EQ(read_case_info(output).scene.trained, 1);
  fs::remove(output);
  EXPECT_TRUE(build_file());
  input_.options.training.steps = 21;
  EXPECT_TRUE(build_file());
}

TEST_F(BuildCaseTest, AnotherVolumeOrLookIsAnotherPicture) {
  build(input_);
  expect_again(
      "volume", [](Input& i) { i.volume.values.unpack()[i.volume.offset(12, 12, 12)] = 200; },
      lines("volume"));
  expect_again("preset", [](Input& i) { i.preset.surface_strength *= 2; }, lines("preset"));
  expect_again("lights", [](Input& i) { i.preset.rig = load_rig("ambient"); }, lines("lights"));
  expect_again("tone", [](Input& i) { i.preset.tone = ToneCurve::kFilmic; }, lines("tone"));
  expect_as_from_scratch();
}

TEST_F(BuildCaseTest, LooksOfOneVolumeSayThatTheyAre) {
  input_.options.training.steps = 1;
  input_.preset.title = "First";
  build(input_);
  const VolumeLook first = look_;
  EXPECT_EQ(first.volume.size(), 16u);
  EXPECT_EQ(first.title, "First");

  // Work that was kept, though the preset's words are others by now.
  input_.preset.title = "Second";
  input_.preset.description = "Brighter.";
  build(input_);
  EXPECT_THAT(said_, HasSubstr("training: done before"));
  EXPECT_EQ(look_, (VolumeLook{first.volume, "Second", "Brighter.", Modality::kCt}));

  input_.preset.surface_strength *= 2;
  build(input_);
  EXPECT_EQ(look_.volume, first.volume);
  input_.volume.values.unpack()[input_.volume.offset(12, 12, 12)] = 200;
  build(input_);
  EXPECT_EQ(look_.volume.size(), 16u);
  EXPECT_NE(look_.volume, first.volume);
}

TEST_F(BuildCaseTest, ThePapersWayKeepsItsModelWhereItCan) {
  input_.options.papers_way = true;
  input_.options.pictures.train_frames = 16;  // some across the axis
  build(input_);
  expect_again(
      "section size", [](Input& i) { i.options.section.size = 9; },
      {"section: made again, the size changed", "refinement: made again, the section changed"});
  expect_again("seed of training", [](Input& i) { i.options.training.seed = 3; },
               {"model: made again, the seed changed",
                "refinement: made again, the model and the seed changed"});
  expect_as_from_scratch();
}

TEST_F(BuildCaseTest, WorkOfAnUnknownProgramIsNotTrusted) {
  const std::vector<float> expected = build(input_);
  for (const char* name : {"dataset/transforms", "dataset/points", "dataset/section", "scene"}) {
    fs::remove(folder_ / "work" / (std::string(name) + ".made-of.json"));
  }
  write_text(folder_ / "work/scene.checkpoint", "of an older program");
  write_text(folder_ / "work/scene.ply", "of an older program");
  EXPECT_TRUE(build(input_) == expected);
  EXPECT_THAT(said_, HasSubstr("pictures: made again, it is not known of what it was made"));
  EXPECT_THAT(said_, HasSubstr("training: made again, it is not known of what it was made"));
}

TEST_F(BuildCaseTest, ASceneThatLostItsSectionIsMadeAgain) {
  const std::vector<float> expected = build(input_);
  ASSERT_TRUE(fs::remove(folder_ / "work/scene.section.zip"));
  EXPECT_TRUE(build(input_) == expected);
}

TEST_F(BuildCaseTest, ACheckpointOfOtherWorkIsNotGoneOnFrom) {
  const std::vector<float> expected = build(input_);
  Input other;
  other.options.training.steps = 21;
  // What a kill in the training of the other leaves: its claim, and a checkpoint.
  {
    const Dataset dataset = load_dataset(folder_ / "work/dataset");
    Trainer trainer(dataset, other.options.training);
    trainer.step();
    build(other);
    fs::remove(folder_ / "work/scene.ply");
    trainer.save_checkpoint(folder_ / "work/scene.checkpoint");
  }
  EXPECT_TRUE(build(input_) == expected);
  EXPECT_THAT(said_, HasSubstr("training: made again, the steps changed"));
  EXPECT_FALSE(fs::exists(folder_ / "work/scene.checkpoint"));
}

}  // namespace
}  // namespace clipgs
