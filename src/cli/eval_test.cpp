// clipgs eval as a user runs it.
#include <algorithm>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <unistd.h>

#include "cli/process.h"
#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::Finished;
using testing_support::run_clipgs;

class EvalCommandTest : public testing::Test {
 protected:
  EvalCommandTest() {
    fs::create_directories(folder_);
    make_dataset("dataset", "1");
    run({"train", at("dataset"), "-o", at("scene.ply"), "--steps", "20", "--budget", "1000"});
  }
  ~EvalCommandTest() override { fs::remove_all(folder_); }
  EvalCommandTest(const EvalCommandTest&) = delete;
  EvalCommandTest& operator=(const EvalCommandTest&) = delete;

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  static void run(std::vector<std::string> arguments) {
    arguments.emplace_back("--quiet");
    const Finished finished = run_clipgs(arguments);
    ASSERT_EQ(finished.status, 0) << finished.err;
  }

  void make_dataset(const std::string& name, const std::string& test_frames) const {
    run({"phantom", at("phantom.nrrd"), "--size", "32"});
    run({"dataset", at("phantom.nrrd"), "-o", at(name), "--size", "32", "--train-frames", "4",
         "--test-frames", test_frames, "--test-noise-db", "25", "--test-masked-noise-db", "0",
         "--points", "2000"});
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("clipgs-eval-" + std::to_string(getpid()));
};

TEST_F(EvalCommandTest, MeasuresASceneAndACase) {
  run({"pack", at("scene.ply"), "-o", at("case.sog")});
  const Finished info = run_clipgs({"info", at("case.sog"), "--json"});
  EXPECT_EQ(nlohmann::json::parse(info.out).at("title"), "Trunk, soft tissue");
  EXPECT_EQ(nlohmann::json::parse(info.out).at("created").get<std::string>().size(), 10u);
  for (const std::string& scene : {at("scene.ply"), at("case.sog")}) {
    const Finished finished =
        run_clipgs({"eval", scene, "--dataset", at("dataset"), "--json", at("figures.json"),
                    "--report", at("report.html"), "--clip", "soft,exact"});
    ASSERT_EQ(finished.status, 0) << finished.err;
    EXPECT_THAT(finished.out, HasSubstr("test_oblique"));
    const auto json = nlohmann::json::parse(read_text(at("figures.json")));
    EXPECT_EQ(json["bytes"], fs::file_size(scene));
    EXPECT_EQ(json["rows"].size(), 8u);  // two splits, two operators, volume and splats
    EXPECT_GT(json["rows"][0]["psnr_masked"], 3.0);
    EXPECT_THAT(read_text(at("report.html")), HasSubstr("Not for diagnosis"));
  }
}

TEST_F(EvalCommandTest, MeasuresOnlyWhatIsAskedFor) {
  const auto rows = [&](const std::string& section) {
    run({"eval", at("scene.ply"), "--dataset", at("dataset"), "--json", at("figures.json"),
         "--clip", "exact", "--section", section});
    return nlohmann::json::parse(read_text(at("figures.json")))["rows"];
  };
  EXPECT_EQ(rows("volume")[0]["section"], "volume");
  EXPECT_EQ(rows("splats").size(), 2u);

  run({"train", at("dataset"), "-o", at("scene.ply"), "--steps", "20", "--budget", "1000",
       "--no-section"});
  const Finished finished =
      run_clipgs({"eval", at("scene.ply"), "--dataset", at("dataset"), "--section", "volume"});
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.err, HasSubstr("no section"));
}

TEST_F(EvalCommandTest, RefusesToOverwriteTheScene) {
  const std::string before = read_text(at("scene.json"));
  const Finished finished =
      run_clipgs({"eval", at("scene.ply"), "--dataset", at("dataset"), "--json", at("scene.json")});
  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.err, HasSubstr("belongs to the scene"));
  EXPECT_EQ(read_text(at("scene.json")), before);
}

TEST_F(EvalCommandTest, BadInputIsOneLine) {
  make_dataset("untested", "0");
  for (const auto& [dataset, says] :
       {std::pair{"untested", "no pictures of test_axis"}, {"none", "none"}}) {
    const Finished finished =
        run_clipgs({"eval", at("scene.ply"), "--dataset", at(dataset), "--json", at("out.json")});
    EXPECT_EQ(finished.status, 1);
    EXPECT_THAT(finished.err, HasSubstr(says));
    EXPECT_EQ(std::ranges::count(finished.err, '\n'), 1) << finished.err;
    EXPECT_FALSE(fs::exists(at("out.json")));
  }
  EXPECT_EQ(
      run_clipgs({"eval", at("scene.ply"), "--dataset", at("dataset"), "--clip", "no"}).status, 2);
}

}  // namespace
}  // namespace clipgs
