#include "study/study_csv.h"

#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "study/records.h"
#include "study/test_records.h"

namespace clipgs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kItems =
    "participant,mode,q1,q2,q3,q4,q5,q6,q7,q8,q9,q10,efficiency,errors\n"
    "1,uniaxial,5,1,5,1,5,1,5,1,5,1,4,2.5\n"
    "1,arbitrary,3,3,3,3,3,3,3,3,3,3,5,0\n";

StudyTable parse_csv(std::string_view text) { return parse_study_csv(text, "t.csv"); }

void expect_no_csv(std::string_view text, const std::string& says) {
  try {
    parse_csv(text);
    ADD_FAILURE() << "was read: " << text;
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr(says));
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
  }
}

TEST(StudyCsv, ReadsAnswersAndMeasures) {
  const StudyTable table = parse_csv(kItems);
  EXPECT_THAT(table.measures, ElementsAre("sus", "efficiency", "errors"));
  ASSERT_EQ(table.rows.size(), 2);
  EXPECT_EQ(table.rows[0].participant, "1");
  EXPECT_EQ(table.rows[0].mode, "uniaxial");
  EXPECT_EQ(table.rows[0].values.at("sus"), 100);
  EXPECT_EQ(table.rows[0].values.at("efficiency"), 4);
  EXPECT_EQ(table.rows[0].values.at("errors"), 2.5);
  EXPECT_EQ(table.rows[1].values.at("sus"), 50);
  EXPECT_EQ(table.rows[0].place, "t.csv:2");
}

TEST(StudyCsv, ColumnsMayComeInAnyOrderAndHaveCapitals) {
  const StudyTable table = parse_csv(
      "TLX6;Mode;tlx1;tlx2;tlx3;tlx4;tlx5;SUS;Participant\n"
      "70;a;10,5;20;30;40;50;72,5;007\n");
  EXPECT_THAT(table.measures, ElementsAre("sus", "tlx"));
  EXPECT_EQ(table.rows[0].participant, "7");
  EXPECT_EQ(table.rows[0].values.at("sus"), 72.5);
  EXPECT_NEAR(table.rows[0].values.at("tlx"), 220.5 / 6, 1e-12);
  EXPECT_THAT(table.rows[0].answers.at("tlx"), ElementsAre(10.5, 20, 30, 40, 50, 70));
}

TEST(StudyCsv, EmptyCellsAreMissingValuesWithAReason) {
  const StudyTable table = parse_csv(
      "participant,mode,q1,q2,q3,q4,q5,q6,q7,q8,q9,q10,efficiency\n"
      "1,a,5,1,,1,5,1,,1,5,1,4\n"
      "2,a,5,1,5,1,5,1,5,1,5,1,\n");
  EXPECT_FALSE(table.rows[0].values.contains("sus"));
  EXPECT_EQ(table.rows[0].missing.at("sus"), "no answer to q3 at t.csv:2");
  EXPECT_EQ(table.rows[0].values.at("efficiency"), 4);
  EXPECT_EQ(table.rows[1].missing.at("efficiency"), "no value at t.csv:3");
}

TEST(StudyCsv, SaysWhichNumberIsWrong) {
  const std::string head = "participant,mode,efficiency,sus,x\n1,a,";
  expect_no_csv(head + "6,50,1\n",
                "t.csv:2: efficiency is 6, which is no whole number from 1 to 5");
  expect_no_csv(head + "0,50,1\n", "efficiency is 0");
  expect_no_csv(head + "3.5,50,1\n", "efficiency is 3.5");
  expect_no_csv(head + "3,100.5,1\n", "sus is 100.5, which is no number from 0 to 100");
  expect_no_csv(head + "3,-1,1\n", "sus is -1");
  for (const char* text : {"nan", "inf", "-inf", "1e999", "0x10", "1.2.3", "12 s", "NA", "+1",
                           "1e13", "\"1,5\"", "x"}) {
    expect_no_csv(head + "3,50," + text + "\n", "t.csv:2: x is ");
  }
  expect_no_csv("participant,mode,q1,q2,q3,q4,q5,q6,q7,q8,q9,q10\n1,a,5,1,5,1,5,1,5,1,5,7\n",
                "q10 is 7");
}

TEST(StudyCsv, SaysWhatTheHeaderLacks) {
  expect_no_csv("mode,sus\na,50\n", "the header has no columns");
  expect_no_csv("participant,mode,q1,q2\n1,a,1,2\n", "the header has no column q10");
  expect_no_csv("participant,mode,tlx2\n1,a,1\n", "the header has no column tlx6");
  expect_no_csv("participant,mode,sus,SUS\n1,a,1,2\n", "two columns \"sus\"");
  expect_no_csv("participant,mode,,x\n1,a,1,2\n", "a column's name is empty");
  expect_no_csv("participant,mode,q1,q2,q3,q4,q5,q6,q7,q8,q9,q10,sus\n1,a,3,3,3,3,3,3,3,3,3,3,50\n",
                "both \"sus\" and the answers");
  expect_no_csv("participant,mode,tlx1,tlx2,tlx3,tlx4,tlx5,tlx6,tlx\n1,a,1,1,1,1,1,1,1\n",
                "both \"tlx\" and the answers");
  expect_no_csv(csv_header_of_records() + "\n" + csv_of_record(test::study_session()[0]) + "\n",
                "t.csv:1: is what one session recorded");
  expect_no_csv("participant,mode,sus\n", "t.csv: has a header, but no rows");
}

TEST(StudyCsv, SaysWhoIsThereTwice) {
  expect_no_csv("participant,mode,sus\n1,a,50\n1,b,50\n01,a,60\n",
                "t.csv:4: participant 1 has answers in mode a already, at t.csv:2");
  expect_no_csv("participant,mode,sus\n,a,50\n", "t.csv:2: a participant is empty");
  expect_no_csv("participant,mode,sus\n1,,50\n", "t.csv:2: a mode is empty");
}

TEST(StudyCsv, ThousandsAreNotTakenForDecimals) {
  EXPECT_EQ(parse_csv("participant;mode;x\n1;a;2.5\n").rows[0].values.at("x"), 2.5);
  expect_no_csv("participant;mode;x\n1;a;2.5\n1;b;1,234\n", "t.csv:3: \"1,234\" has another");
}

TEST(StudyCsv, JoinsTablesAndFindsWhoIsInBoth) {
  StudyTable table = parse_csv("participant,mode,sus\n1,a,50\n");
  join(table, parse_study_csv("participant,mode,efficiency\n1,b,3\n", "u.csv"));
  EXPECT_THAT(table.measures, ElementsAre("sus", "efficiency"));
  EXPECT_EQ(table.rows.size(), 2);
  EXPECT_THROW(join(table, parse_study_csv("participant,mode,sus\n1,b,3\n", "v.csv")), Error);
}

TEST(StudyCsv, WritesWhatItReads) {
  const StudyTable table = parse_csv(
      "participant,mode,q1,q2,q3,q4,q5,q6,q7,q8,q9,q10,efficiency,tlx,\"a, b\"\n"
      "10,uniaxial,5,1,5,1,5,1,5,1,5,1,4,33.3,0.1\n"
      "2,\"mode #2\",3,3,,3,3,3,3,3,3,3,,50,-7e-9\n");
  const std::string text = study_csv(table);
  EXPECT_EQ(text,
            "participant,mode,q1,q2,q3,q4,q5,q6,q7,q8,q9,q10,efficiency,tlx,\"a, b\"\n"
            "2,\"mode #2\",,,,,,,,,,,,50,-7e-09\n"
            "10,uniaxial,5,1,5,1,5,1,5,1,5,1,4,33.3,0.1\n");
  EXPECT_EQ(study_csv(parse_csv(text)), text);
}

TEST(StudyCsv, ScoresWithoutAnswersAreWrittenAsScores) {
  StudyTable table = parse_csv(kItems);
  join(table, parse_csv("participant,mode,sus\n2,uniaxial,61.2\n"));
  EXPECT_THAT(study_csv(table),
              HasSubstr("participant,mode,sus,efficiency,errors\n1,arbitrary,50,"));
}

TEST(StudyCsv, LargeFilesAreRefused) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) /
                                     ("clipgs-study-" + std::to_string(getpid()) + ".csv");
  write_text(path, kItems);
  EXPECT_EQ(read_study_csv(path).rows.size(), 2);
  std::filesystem::resize_file(path, kMostCsvBytes + 1);
  EXPECT_THROW(read_study_csv(path), Error);
  std::filesystem::remove(path);
}

TEST(StudyTable, ParticipantsAreInOrderOfTheirNumbers) {
  EXPECT_TRUE(participant_order("2", "10"));
  EXPECT_FALSE(participant_order("10", "2"));
  EXPECT_TRUE(participant_order("10", "anna"));
  EXPECT_FALSE(participant_order("2", "2"));
}

}  // namespace
}  // namespace clipgs
