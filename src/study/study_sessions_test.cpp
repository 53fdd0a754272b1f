#include "study/study_sessions.h"

#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "study/comparison.h"
#include "study/session_log.h"
#include "study/study_csv.h"
#include "study/test_records.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// A session as the browser records it.
struct SessionText {
  explicit SessionText(int participant, const std::string& plan = "clipgs-vr") {
    StudyRecord record = test::study_session()[0];
    record["participant"] = participant;
    record["plan"] = plan;
    add(record);
  }
  void add(StudyRecord record) {
    record["seq"] = count++;
    text += record.dump() + '\n';
  }
  void task(const std::string& mode, double seconds, bool practice = false,
            const std::string& outcome = "done") {
    StudyRecord record = test::study_session()[1];
    record["mode"] = mode;
    record["seconds"] = seconds;
    record["practice"] = practice;
    record["outcome"] = outcome;
    add(record);
  }
  void answers(const std::string& mode, const std::string& questionnaire,
               const std::vector<int>& given) {
    add({{"kind", "answers"},
         {"mode", mode},
         {"questionnaire", questionnaire},
         {"answers", given}});
  }
  void mode(const std::string& name, double seconds, int efficiency) {
    task(name, 500, true);
    task(name, seconds);
    task(name, seconds + 10);
    answers(name, "sus", {5, 1, 5, 1, 5, 1, 5, 1, 5, efficiency});
    answers(name, "efficiency", {efficiency});
  }
  void end() { add({{"kind", "end"}}); }

  std::string text;
  int count = 0;
};

class StudySessionsTest : public testing::Test {
 protected:
  StudySessionsTest()
      : folder_(fs::path(testing::TempDir()) /
                ("clipgs-study-sessions-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~StudySessionsTest() override { fs::remove_all(folder_); }

  void write(const std::string& name, const SessionText& session) const {
    write_text(folder_ / name, session.text);
  }
  void write_whole(int participant) const {
    SessionText session(participant);
    session.mode("uniaxial", 40 + participant, 2);
    session.mode("arbitrary", 20 + participant % 3, 4);
    session.end();
    write(fmt::format("p{:03}-00000000.jsonl", participant), session);
  }
  void expect_failure(const std::string& says) const {
    try {
      read_study_sessions(folder_);
      ADD_FAILURE() << "was read";
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr(says));
    }
  }

  fs::path folder_;
};

TEST_F(StudySessionsTest, GiveARowForEachMode) {
  write_whole(7);
  write_text(folder_ / "p007-00000000.csv", "not read");
  const StudyTable table = read_study_sessions(folder_);
  EXPECT_THAT(table.measures,
              ElementsAre("sus", "efficiency", "seconds", "travel_mm", "rotation_deg", "head_mm",
                          "head_deg", "distance_mm", "regrasps", "frame_ms"));
  ASSERT_EQ(table.rows.size(), 2);
  const StudyRow& arbitrary = table.rows[0];
  EXPECT_EQ(arbitrary.participant, "7");
  EXPECT_EQ(arbitrary.mode, "arbitrary");
  EXPECT_EQ(arbitrary.values.at("seconds"), 26);  // 21 and 31, without the practice
  EXPECT_EQ(arbitrary.values.at("efficiency"), 4);
  EXPECT_EQ(arbitrary.values.at("sus"), 92.5);
  EXPECT_EQ(arbitrary.values.at("head_mm"), 410.2);
  EXPECT_TRUE(table.remarks.empty());
}

TEST_F(StudySessionsTest, AreWhatTheServerRecords) {
  SessionLog(folder_).append("p007-3f9c2a1b", test::study_lines());
  const StudyTable table = read_study_sessions(folder_);
  ASSERT_EQ(table.rows.size(), 1);
  EXPECT_TRUE(table.remarks.empty());
  const StudyRow& row = table.rows[0];
  EXPECT_EQ(row.participant, "7");
  EXPECT_EQ(row.values.at("sus"), 100);
  EXPECT_EQ(row.values.at("efficiency"), 4);
  EXPECT_EQ(row.values.at("seconds"), 31.25);
  EXPECT_THAT(row.missing.at("angle_deg"), HasSubstr("not measured in"));
}

TEST_F(StudySessionsTest, AreComparedAndExported) {
  for (const int participant : {1, 2, 3, 4, 5}) {
    write_whole(participant);
  }
  const StudyTable table = read_study_sessions(folder_);
  const StudyComparison comparison = compare_modes(table);
  EXPECT_EQ(comparison.participants, 5);
  EXPECT_TRUE(comparison.exclusions.empty());
  const std::string csv = study_csv(table);
  EXPECT_THAT(csv,
              HasSubstr("participant,mode,q1,q2,q3,q4,q5,q6,q7,q8,q9,q10,efficiency,seconds,"));
  const StudyComparison again = compare_modes(parse_study_csv(csv, "export.csv"));
  for (size_t i = 0; i < comparison.measures.size(); ++i) {
    EXPECT_EQ(again.measures.at(i).measure, comparison.measures[i].measure);
    EXPECT_EQ(again.measures[i].p, comparison.measures[i].p);
    EXPECT_EQ(again.measures[i].first->mean, comparison.measures[i].first->mean);
  }
}

TEST_F(StudySessionsTest, TasksOutOfTimeCountAndAreTold) {
  SessionText session(1);
  session.mode("uniaxial", 40, 2);
  session.task("arbitrary", 180, false, "time");
  session.task("arbitrary", 20);
  session.answers("arbitrary", "sus", {3, 3, 3, 3, 3, 3, 3, 3, 3, 3});
  session.end();
  write("p001-00000000.jsonl", session);
  const StudyTable table = read_study_sessions(folder_);
  EXPECT_EQ(table.rows[0].values.at("seconds"), 100);
  EXPECT_THAT(table.remarks, ElementsAre(HasSubstr("1 of 2 tasks in mode arbitrary ran out")));
}

TEST_F(StudySessionsTest, OfAnUnfinishedOneWholeModesCount) {
  SessionText session(3);
  session.mode("uniaxial", 40, 2);
  session.task("arbitrary", 33);
  write("p003-00000000.jsonl", session);
  write_whole(4);
  const StudyTable table = read_study_sessions(folder_);
  EXPECT_EQ(table.rows.size(), 3);
  EXPECT_THAT(table.remarks, ElementsAre(HasSubstr("p003-00000000.jsonl: is not finished; "
                                                   "participant 3 is left out in mode arbitrary")));
  const StudyComparison comparison = compare_modes(table);
  ASSERT_EQ(comparison.exclusions.size(), 1);
  EXPECT_EQ(comparison.exclusions[0].participant, "3");
  EXPECT_EQ(comparison.remarks, table.remarks);
}

TEST_F(StudySessionsTest, OfTwoTheFinishedOneCounts) {
  write_whole(3);
  write("p003-11111111.jsonl", SessionText(3));
  const StudyTable table = read_study_sessions(folder_);
  EXPECT_EQ(table.rows.size(), 2);
  EXPECT_THAT(table.remarks, ElementsAre(HasSubstr("p003-11111111.jsonl: is not finished and left "
                                                   "out; participant 3 has a finished session")));
  fs::copy_file(folder_ / "p003-00000000.jsonl", folder_ / "p003-22222222.jsonl");
  expect_failure("participant 3 has 3 sessions; keep one of them");
  expect_failure("p003-22222222.jsonl");
}

TEST_F(StudySessionsTest, ALineThatWasCutOffIsLeftOut) {
  write_whole(3);
  const fs::path file = folder_ / "p003-00000000.jsonl";
  fs::resize_file(file, fs::file_size(file) - 5);
  const StudyTable table = read_study_sessions(folder_);
  EXPECT_THAT(table.remarks, Contains(HasSubstr("the last line was cut off")));
  EXPECT_EQ(table.rows.size(), 2) << "both modes were finished";
}

TEST_F(StudySessionsTest, SayWhatIsWrong) {
  expect_failure("there are no sessions (*.jsonl)");
  write_text(folder_ / "a.jsonl", "");
  expect_failure("a.jsonl: holds no session");
  write_text(folder_ / "a.jsonl", "{}\n");
  expect_failure("a.jsonl:1: this is no record");
  SessionText session(1);
  session.count = 5;
  session.task("uniaxial", 3);
  write("a.jsonl", session);
  expect_failure("a.jsonl:2: this is no record 1 of a session");
  write("a.jsonl", SessionText(1));
  expect_failure("none of 1 sessions has a mode that was finished");
  write("b.jsonl", SessionText(2, "another"));
  expect_failure("b.jsonl: is of the plan another");
}

}  // namespace
}  // namespace clipgs
