#include "archive/archive_rules.h"

#include <cstdlib>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ArchiveRulesTest : public ::testing::Test {
 protected:
  ArchiveRulesTest()
      : folder_(fs::path(::testing::TempDir()) / ("clipgs-rules-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~ArchiveRulesTest() override { fs::remove_all(folder_); }

  ArchiveRules rules_of(const std::string& rest) const {
    write_text(folder_ / "rules.json",
               R"({"clipgs_archive": 1, "orthanc": "http://127.0.0.1:8042", )" + rest + "}");
    return read_rules(folder_ / "rules.json");
  }

  ArchiveRules one_rule(const std::string& rule) const {
    return rules_of(R"("rules": [{"name": "one", )" + rule + "}]");
  }

  /// One line that says so.
  void expect_refused(const std::string& rest, const std::string& says) const {
    try {
      rules_of(rest);
      ADD_FAILURE() << "was taken: " << rest;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(says));
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }

  fs::path folder_;
};

SeriesFacts chest() {
  return {"CT", "CHEST", "Thorax 1.0 Br60 lung", "CHEST W/O", "CT1", "SCANNER", 300, 1.0};
}

TEST_F(ArchiveRulesTest, MatchesAllThatARuleSays) {
  const auto matches = [&](const std::string& rule) {
    return one_rule(rule).find(chest()) != nullptr;
  };
  EXPECT_TRUE(matches(R"("modality": "CT")"));
  EXPECT_TRUE(matches(R"("modality": ["MR", "ct"], "series": "*LUNG*", "ae": "scan?er")"));
  EXPECT_TRUE(matches(R"("slices": [300, 300], "slice_thickness": [null, 1])"));
  EXPECT_TRUE(matches(R"("study": "chest*", "station": "CT[12]", "body_part": "CHEST")"));
  EXPECT_FALSE(matches(R"("modality": "MR")"));
  EXPECT_FALSE(matches(R"("modality": "CT", "series": "lung")"));  // not a part of it
  EXPECT_FALSE(matches(R"("slices": [301, null])"));
  EXPECT_FALSE(matches(R"("slice_thickness": [1.5, 3])"));

  SeriesFacts unknown = chest();
  unknown.slice_thickness.reset();
  EXPECT_EQ(one_rule(R"("slice_thickness": [0, 100])").find(unknown), nullptr);
}

TEST_F(ArchiveRulesTest, TakesTheFirstRuleThatMatches) {
  const ArchiveRules rules = rules_of(
      R"("rules": [{"name": "no scouts", "series": "*scout*", "skip": true},
                   {"name": "lungs", "series": "*lung*"}, {"name": "rest"}])");
  EXPECT_EQ(rules.find(chest())->name, "lungs");
  SeriesFacts other = chest();
  other.series = "Scout lung";
  EXPECT_EQ(rules.find(other), nullptr);
  other.series = "";
  EXPECT_EQ(rules.find(other)->name, "rest");
}

TEST_F(ArchiveRulesTest, ReadsWhatIsToBeDone) {
  const ArchiveRules rules = rules_of(
      R"("public_url": "https://cases.example", "tries": 2, "settle_seconds": 0,
         "rules": [{"name": "one", "folder": "ct/chest", "back": "report",
                    "build": {"quality": "draft", "size": 64, "deface": true, "bias": false}}])");
  EXPECT_EQ(rules.public_url, "https://cases.example/");
  EXPECT_EQ(rules.tries, 2);
  EXPECT_EQ(rules.settle.count(), 0);
  EXPECT_EQ(rules.poll.count(), 5);
  const ArchiveRule& rule = rules.rules.front();
  EXPECT_EQ(rule.folder, "ct/chest");
  EXPECT_TRUE(rule.back.report);
  EXPECT_FALSE(rule.back.film || rule.back.link);
  EXPECT_THAT(rule.build, ElementsAre("--deface", "--quality", "draft", "--size", "64"));
}

TEST_F(ArchiveRulesTest, RefusesWhatItDoesNotKnow) {
  expect_refused(R"("rules": [{"name": "one"}], "pol_seconds": 3)", "\"pol_seconds\"");
  expect_refused(R"("rules": [{"name": "one", "modalities": "CT"}])", "rules[0]: \"modalities\"");
  expect_refused(R"("rules": [{"name": "one", "modality": 3}])", "a text, or a list of texts");
  expect_refused(R"("rules": [{"name": "one", "slices": 30}])", "[least, most]");
  expect_refused(R"("rules": [{"name": "one", "slices": [9, 2]}])", "in this order");
  expect_refused(R"("rules": [{"name": "one", "build": {"work": "/"}}])", "\"build.work\"");
  expect_refused(R"("rules": [{"name": "one", "build": {"preset": "skin,bone"}}])", "one preset");
  expect_refused(R"("rules": [{"name": "one", "back": ["movie"]}])", "\"film\"");
  expect_refused(R"("rules": [{"name": "one", "folder": "../up"}])", "\"folder\"");
  expect_refused(R"("rules": [{"name": "one"}, {"name": "one"}])", "a second rule");
  expect_refused(R"("rules": [])", "at least one rule");
  expect_refused(R"("rules": [{"modality": "CT"}])", "\"name\"");
  expect_refused(R"("tries": 0, "rules": [{"name": "one"}])", "\"tries\"");
  expect_refused(R"("rules": [{"name": "one"}], "public_url": "cases")", "\"public_url\"");
  write_text(folder_ / "rules.json", "[]");
  EXPECT_THROW(read_rules(folder_ / "rules.json"), Error);
}

TEST_F(ArchiveRulesTest, KeepsCredentialsToItsOwner) {
  ArchiveRules rules;
  EXPECT_EQ(read_credentials(rules).user, "");
  rules.credentials = folder_ / "credentials";
  EXPECT_THROW(read_credentials(rules), Error);
  write_text(rules.credentials, "clipgs:a:b\n");
  fs::permissions(rules.credentials, fs::perms::owner_read | fs::perms::group_read);
  EXPECT_THROW(read_credentials(rules), Error);
  fs::permissions(rules.credentials, fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(read_credentials(rules).user, "clipgs");
  EXPECT_EQ(read_credentials(rules).password, "a:b");
  write_text(rules.credentials, "nothing");
  EXPECT_THROW(read_credentials(rules), Error);
}

TEST_F(ArchiveRulesTest, ReadsTheExample) {
  const ArchiveRules rules =
      read_rules(fs::path(CLIPGS_SOURCE_DIR) / "packaging/orthanc/rules.json");
  EXPECT_EQ(rules.find(chest())->name, "lungs");
}

}  // namespace
}  // namespace clipgs
