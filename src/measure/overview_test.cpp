#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "asset/case.h"
#include "core/error.h"
#include "core/file.h"
#include "measure/overview_figures.h"
#include "measure/overview_page.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using State = OverviewEntry::State;
using testing::HasSubstr;
using testing::Not;

/// A folder of cases with a table of its own.
class OverviewTest : public testing::Test {
 protected:
  OverviewTest() { fs::create_directories(folder_); }
  ~OverviewTest() override { fs::remove_all(folder_); }

  void add_case(const std::string& name, const std::string& title) {
    Scene scene;
    scene.gaussians = Gaussians(3, 0);
    scene.gaussians.plane(Gaussians::kRotation)[0] = 1;
    scene.gaussians.plane(Gaussians::kRotation)[1] = 1;
    scene.gaussians.plane(Gaussians::kRotation)[2] = 1;
    scene.sphere = {{0, 0, 0}, 10};
    scene.title = title;
    scene.trained = 1;
    const Image thumbnail(8, 8, 3);
    write_case(folder_ / (name + ".sog"), scene, &thumbnail);
    planned_.push_back({{"name", name}, {"last", "eval"}});
  }
  void add_figures(const std::string& name, double faces) {
    nlohmann::json rows = nlohmann::json::array();
    for (const char* const section : {"splats", "volume"}) {
      for (const char* const split : {"test_axis", "test_oblique", "test_uncut"}) {
        const double less = std::string(section) == "splats" ? 9 : 0;
        rows.push_back({{"subject", name},
                        {"clip", "exact"},
                        {"section", section},
                        {"against", "truth"},
                        {"split", split},
                        {"psnr_masked", 30 - less},
                        {"psnr_face", faces - less}});
      }
    }
    write_text(folder_ / (name + ".figures"),
               nlohmann::json{{"rows", rows},
                              {"masked_noise_floor_db", {{"test_axis", 41}, {"test_uncut", 40}}}}
                   .dump());
  }
  void add_record(const std::string& name, const std::string& step, const nlohmann::json& record) {
    const fs::path batch = folder_ / (name + ".clipgs-work") / "batch";
    fs::create_directories(batch);
    write_text(batch / (step + ".json"), record.dump());
  }
  void add_log(const std::string& name, const std::string& step, const std::string& log) {
    write_text(folder_ / (name + ".clipgs-work") / "batch" / (step + ".log"), log);
  }
  std::vector<OverviewEntry> gather() {
    write_text(folder_ / "batch.json", nlohmann::json{{"cases", planned_}}.dump());
    return gather_overview(folder_);
  }

  fs::path folder_ = fs::path(testing::TempDir()) / fmt::format("clipgs-overview-{}", getpid());
  nlohmann::json planned_ = nlohmann::json::array();
};

TEST_F(OverviewTest, WhatFailedStandsFirstThenWhatStandsOut) {
  for (int i = 0; i < 10; ++i) {
    const std::string name = fmt::format("c{}", i);
    add_case(name, "Usual");
    add_figures(name, i == 7 ? 20 : 35 + 0.1 * i);
    add_record(name, "build", {{"status", "done"}, {"seconds", 90}, {"peak_mb", 700}});
    add_record(name, "eval", {{"status", "done"}, {"seconds", 30}, {"peak_mb", 200}});
  }
  planned_.push_back({{"name", "z-waits"}, {"last", "eval"}});
  planned_.push_back({{"name", "z-broken"}, {"last", "eval"}});
  add_record("z-broken", "build",
             {{"status", "failed"}, {"last_line", "clipgs: /data/Doe/ct: is no volume"}});
  add_log("c3", "build", "");
  add_log("c3", "build", "warning: /data/Doe/ct: took 12 ml of table off\n");

  const std::vector<OverviewEntry> entries = gather();
  ASSERT_EQ(entries.size(), 12U);
  EXPECT_EQ(entries[0].name, "z-broken");
  EXPECT_EQ(entries[0].failure, "build: clipgs: …: is no volume");
  EXPECT_EQ(entries[1].name, "z-waits");
  EXPECT_EQ(entries[1].state, State::kUnfinished);
  EXPECT_EQ(entries[2].name, "c7");
  ASSERT_EQ(entries[2].reasons.size(), 1U);
  EXPECT_EQ(entries[2].reasons[0], "faces 20.0 dB, where the median is 35.3 dB");
  EXPECT_TRUE(entries[3].reasons.empty());
  EXPECT_EQ(entries[3].figures[static_cast<size_t>(Figure::kMinutes)], 2.0);
  EXPECT_EQ(entries[3].figures[static_cast<size_t>(Figure::kNoiseFloor)], 40.0);

  const std::string page = overview_page(entries);
  EXPECT_THAT(page, HasSubstr("12 cases: 10 finished, 1 failed, 1 not finished; 1 stand out."));
  EXPECT_THAT(page, HasSubstr("12 ml of table and cushions taken off"));
  EXPECT_THAT(page, Not(HasSubstr("Doe")));
  EXPECT_FALSE(page.find("https:") != page.npos || page.find("http:") != page.npos);
}

TEST_F(OverviewTest, ACaseThatIsMadeAgainIsNotFinishedUntilItIsMeasured) {
  add_case("a", "Old");
  add_record("a", "build", {{"status", "running"}, {"seconds", 1}});
  add_record("a", "eval", {{"status", "running"}, {"seconds", 1}});
  EXPECT_EQ(gather()[0].state, State::kUnfinished);
  add_record("a", "eval", {{"status", "failed"}, {"last_line", "was ended by SIGKILL"}});
  EXPECT_EQ(gather()[0].failure, "eval: was ended by SIGKILL");
}

TEST_F(OverviewTest, WhatFailedBeforeTheEndWasReachedIsForgotten) {
  add_case("a", "A");
  add_record("a", "dataset", {{"status", "failed"}, {"began", "2026-01-01T10:00:00+00:00"}});
  add_record("a", "eval", {{"status", "done"}, {"began", "2026-01-01T11:00:00+00:00"}});
  EXPECT_EQ(gather()[0].state, State::kDone);
  add_record("a", "dataset", {{"status", "failed"}, {"began", "2026-01-01T12:00:00+00:00"}});
  EXPECT_EQ(gather()[0].state, State::kFailed);
}

TEST_F(OverviewTest, CasesAloneAreEnough) {
  add_case("a b&c", "A <b> & \"more\"");
  add_case("second", "Two");
  write_text(folder_ / "broken.sog", "no case");
  write_text(folder_ / "second.figures", "[1, 2");
  write_text(folder_ / "batch.json", "{\"cases\": [3, {\"name\": \"../../etc\"}, {\"name\": 4}]}");
  const std::vector<OverviewEntry> entries = write_overview(folder_);
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[0].name, "broken");
  EXPECT_EQ(entries[0].state, State::kFailed);
  EXPECT_EQ(entries[1].state, State::kDone);
  const std::string page = read_text(folder_ / "overview" / "index.html");
  EXPECT_THAT(page, HasSubstr("A &lt;b&gt; &amp; &quot;more&quot;"));
  EXPECT_THAT(page, HasSubstr("src=\"a%20b%26c.webp\""));
  EXPECT_TRUE(fs::exists(folder_ / "overview" / "a b&c.webp"));
  EXPECT_FALSE(fs::exists(folder_ / "overview" / "broken.webp"));
}

TEST_F(OverviewTest, WhatIsNoFolderOrEmptyIsRefused) {
  EXPECT_THROW(write_overview(folder_), Error);
  EXPECT_THROW(write_overview(folder_ / "absent"), Error);
}

TEST_F(OverviewTest, FiguresOfAnotherKindAreNone) {
  for (const char* const text :
       {"null", "[]", "{}", R"({"rows": 3})", R"({"rows": [3]})", R"({"rows": [{}]})",
        R"({"rows": [{"subject": 1}, 7], "masked_noise_floor_db": [2]})"}) {
    OverviewEntry entry;
    add_measured(nlohmann::json::parse(text), entry);
    for (const std::optional<double>& value : entry.figures) {
      EXPECT_FALSE(value) << text;
    }
  }
}

}  // namespace
}  // namespace clipgs
