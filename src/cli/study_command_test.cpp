// clipgs study as a user runs it.
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/cli_fixture.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing_support::CliTest;
using testing_support::Finished;
using testing_support::run_clipgs;

class StudyCommandTest : public CliTest {
 protected:
  static std::string committed(const std::string& name) {
    return (fs::path(CLIPGS_SOURCE_DIR) / "presets" / "study" / name).string();
  }

  /// A finished session of `clipgs serve --study`, without tasks.
  void write_session(const std::string& name, int participant) const {
    const std::string number = std::to_string(participant);
    std::string text =
        R"({"seq":0,"kind":"session","format":1,"plan":"clipgs-vr","digest":"0badcafe",)"
        R"("participant":)" +
        number + R"(,"order":["uniaxial","arbitrary"],"device":"headset"})" + '\n';
    int seq = 1;
    for (const char* mode : {"uniaxial", "arbitrary"}) {
      const int last = 1 + (participant + seq) % 4;
      text += R"({"seq":)" + std::to_string(seq++) + R"(,"kind":"answers","mode":")" + mode +
              R"(","questionnaire":"sus","answers":[5,1,5,1,5,1,5,1,5,)" + std::to_string(last) +
              "]}\n";
    }
    write_text(at("recorded/" + name), text + R"({"seq":3,"kind":"end"})" + '\n');
  }
};

TEST_F(StudyCommandTest, PrintsThePapersStatistics) {
  const Finished study = run_clipgs({"study", committed("synthetic-paper.csv")});
  ASSERT_EQ(study.status, 0) << study.err;
  for (const char* text :
       {"71.80 ± 14.41", "88.20 ± 9.35", "t(9) = −2.988, p = .015 *", "3.40 ± 0.70", "4.70 ± 0.48",
        "W = 0, Z = −2.739, p = .006 *", "11 by the paired t-test"}) {
    EXPECT_THAT(study.out, HasSubstr(text));
  }
  EXPECT_EQ(study.err, "");
}

TEST_F(StudyCommandTest, ChecksMeansWithoutData) {
  const Finished check = run_clipgs(
      {"study", "--check", "71.80,10,2.5", "--check", "88.20,10,2.5", "--check", "3.40,10,1"});
  ASSERT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out,
              HasSubstr("71.80 cannot come from 10 scores that are multiples of 2.5; the nearest "
                        "sums: 717.5 (mean 71.75) and 720 (mean 72.00)\n"));
  EXPECT_THAT(check.out, HasSubstr("88.20 cannot come"));
  EXPECT_THAT(check.out, HasSubstr("3.40 can come"));
}

TEST_F(StudyCommandTest, WritesWhatItIsAskedFor) {
  const Finished study = run_clipgs({"study", committed("synthetic-items.csv"), "--format", "latex",
                                     "-o", at("t.tex"), "--plot", at("p.svg"), "--export",
                                     at("e.csv"), "--json", at("f.json"), "--effect", "0.5"});
  ASSERT_EQ(study.status, 0) << study.err;
  EXPECT_EQ(study.out, "");
  EXPECT_THAT(read_text(at("t.tex")), HasSubstr("\\begin{tabular}"));
  EXPECT_THAT(read_text(at("p.svg")), HasSubstr("</svg>"));
  const auto figures = nlohmann::json::parse(read_text(at("f.json")));
  EXPECT_EQ(figures["planned"]["sample_size"]["t"], 34);
  EXPECT_EQ(figures["measures"][0]["first"]["mean"], 71.75);
  // What is exported is analysed alike.
  const Finished again = run_clipgs({"study", at("e.csv"), "--json", at("g.json")});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(read_text(at("g.json")))["measures"], figures["measures"]);
}

TEST_F(StudyCommandTest, ModesGiveTheOrderOfTheDifference) {
  const Finished study =
      run_clipgs({"study", committed("synthetic-paper.csv"), "--modes", "arbitrary,uniaxial"});
  ASSERT_EQ(study.status, 0) << study.err;
  EXPECT_THAT(study.out, HasSubstr("t(9) = 2.988, p = .015"));
  expect_failure({"study", committed("synthetic-paper.csv"), "--modes", "arbitrary,axial"},
                 "there is no mode axial in the data; choose two of: arbitrary, uniaxial");
}

TEST_F(StudyCommandTest, ReadsSessionsAndTablesTogether) {
  fs::create_directories(at("recorded"));
  for (int participant = 1; participant <= 4; ++participant) {
    write_session("p00" + std::to_string(participant) + "-00000000.jsonl", participant);
  }
  write_text(at("more.csv"),
             "participant;mode;sus\n20;uniaxial;62,5\n20;arbitrary;80\n21;uniaxial;5\n");
  const Finished study = run_clipgs({"study", at("recorded"), at("more.csv")});
  ASSERT_EQ(study.status, 0) << study.err;
  EXPECT_THAT(study.out, HasSubstr("6 participants"));
  EXPECT_THAT(study.out, HasSubstr("participant 21, everything: has no row in mode arbitrary"));
  write_session("p001-11111111.jsonl", 1);
  expect_failure({"study", at("recorded")}, "participant 1 has 2 sessions");
}

TEST_F(StudyCommandTest, FailsInOneLineAndLeavesNothing) {
  write_text(at("bad.csv"), "participant,mode,efficiency\n1,a,3\n1,b,6\n");
  expect_failure({"study", at("bad.csv"), "--export", at("e.csv"), "--plot", at("p.png")},
                 "bad.csv:3: efficiency is 6", at("e.csv"));
  EXPECT_FALSE(fs::exists(at("p.png")));
  expect_failure({"study", at("missing.csv")}, "missing.csv");
  expect_failure({"study", at("bad.csv"), "--export", at("bad.csv")}, "would be overwritten");
  EXPECT_THAT(read_text(at("bad.csv")), HasSubstr("1,b,6"));
}

TEST_F(StudyCommandTest, BadUsageExitsWithTwo) {
  const std::string data = committed("synthetic-paper.csv");
  EXPECT_EQ(run_clipgs({"study"}).status, 2);
  EXPECT_EQ(run_clipgs({"study", "--check", "71.80,10"}).status, 2);
  EXPECT_EQ(run_clipgs({"study", data, "--modes", "uniaxial"}).status, 2);
  EXPECT_EQ(run_clipgs({"study", data, "--format", "html"}).status, 2);
  EXPECT_EQ(run_clipgs({"study", data, "--plot", at("p.pdf")}).status, 2);
  EXPECT_EQ(run_clipgs({"study", data, "--power", "many"}).status, 2);
  EXPECT_EQ(run_clipgs({"study", data, "--power", "0.01"}).status, 1);
}

}  // namespace
}  // namespace clipgs
