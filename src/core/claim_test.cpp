#include "core/claim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/file.h"
#include "core/version.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ClaimTest : public testing::Test {
 protected:
  ClaimTest()
      : folder_(fs::path(testing::TempDir()) / ("clipgs-claim-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~ClaimTest() override { fs::remove_all(folder_); }

  Step step(const Claim& claim) {
    testing::internal::CaptureStderr();
    Step result("pictures", folder_ / "data", claim, {folder_ / "data.ply", folder_ / "data.json"},
                {folder_ / "checkpoint"});
    said_ = testing::internal::GetCapturedStderr();
    return result;
  }
  void write_results() {
    write_text(folder_ / "data.ply", "result");
    write_text(folder_ / "data.json", "result");
  }
  bool there(const char* name) const { return fs::exists(folder_ / name); }

  fs::path folder_;
  std::string said_;
};

TEST_F(ClaimTest, SaysWhatChanged) {
  const Claim claim = {{"size", 3}, {"preset", "abc"}, {"hu", nullptr}};
  EXPECT_EQ(changes(claim, claim), "");
  EXPECT_EQ(changes(claim, Claim::parse(claim.dump())), "");
  Claim other = claim;
  other["preset"] = "abd";
  EXPECT_EQ(changes(claim, other), "the preset changed");
  other["size"] = 4;
  other["test_frames"] = 1;  // of one alone
  EXPECT_EQ(changes(claim, other), "the preset, the size and the test frames changed");
  EXPECT_EQ(changes(other, claim), "the preset, the size and the test frames changed");
}

TEST_F(ClaimTest, NumbersKeepTheirValueInAFile) {
  const Claim claim = {{"float", 0.1f}, {"seed", ~std::uint64_t{0}}, {"int", 7}, {"size", 7U}};
  EXPECT_EQ(changes(claim, Claim::parse(claim.dump())), "");
}

TEST_F(ClaimTest, AnotherProgramIsAChange) {
  EXPECT_THAT(claim_of_step("training", 3).at("program").get<std::string>(),
              HasSubstr(program_version()));
  EXPECT_EQ(changes(claim_of_step("training", 3), claim_of_step("training", 4)),
            "the program changed");
}

TEST_F(ClaimTest, DigestsDiffer) {
  EXPECT_EQ(digest_of({{"a", 1}}).size(), 64U);
  EXPECT_NE(digest_of({{"a", 1}}), digest_of({{"a", 2}}));
}

TEST_F(ClaimTest, WorkIsDoneOnceForWhatItIsMadeOf) {
  const Claim claim = {{"size", 3}};
  EXPECT_TRUE(read_claim(folder_ / "data").is_null());
  {
    const Step first = step(claim);
    EXPECT_FALSE(first.done());
    EXPECT_EQ(said_, "");
    write_results();
    first.finish();
  }
  EXPECT_EQ(read_claim(folder_ / "data"), claim);
  EXPECT_TRUE(step(claim).done());
  EXPECT_EQ(said_, "pictures: done before\n");
  fs::remove(folder_ / "data.json");
  EXPECT_FALSE(step(claim).done());
}

TEST_F(ClaimTest, UnfinishedWorkGoesOn) {
  step({{"size", 3}});
  write_results();
  write_text(folder_ / "checkpoint", "half");
  EXPECT_FALSE(step({{"size", 3}}).done());
  EXPECT_EQ(said_, "");
  EXPECT_TRUE(there("checkpoint"));
  EXPECT_TRUE(there("data.ply"));
}

TEST_F(ClaimTest, StaleWorkIsRemovedAndTheReasonSaid) {
  const auto expect_removed = [&](const Claim& claim, const std::string& says) {
    write_results();
    write_text(folder_ / "checkpoint", "half");
    EXPECT_FALSE(step(claim).done());
    EXPECT_EQ(said_, says);
    EXPECT_FALSE(there("checkpoint") || there("data.ply") || there("data.json"));
  };
  expect_removed({{"size", 3}}, "pictures: made again, it is not known of what it was made\n");
  expect_removed({{"size", 4}}, "pictures: made again, the size changed\n");
  write_text(folder_ / "data.made-of.json", "{\"made_of\": 3}");
  expect_removed({{"size", 4}}, "pictures: made again, it is not known of what it was made\n");
  forget(folder_ / "data", {folder_ / "data.ply"});
  EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace clipgs
