#include "study/session_log.h"

#include <csignal>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <thread>

#include "core/file.h"
#include "study/test_records.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using test::study_lines;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* kSession = "p007-3f9c2a1b";

class SessionLogTest : public ::testing::Test {
 protected:
  std::string lines() const {
    return read_text(folder_ / "study" / (std::string(kSession) + ".jsonl"));
  }
  std::string table() const {
    return read_text(folder_ / "study" / (std::string(kSession) + ".csv"));
  }
  static std::string whole_table() {
    std::string table = csv_header_of_records() + '\n';
    for (const StudyRecord& record : test::study_session()) {
      table += csv_of_record(record) + '\n';
    }
    return table;
  }

  const TestFolder folder_;
};

TEST_F(SessionLogTest, RecordsEveryLineOnce) {
  SessionLog log(folder_ / "study");
  EXPECT_EQ(log.append(kSession, study_lines(0, 2)), 2);
  EXPECT_EQ(log.append(kSession, study_lines(1, 3)), 3) << "the second was sent again";
  EXPECT_EQ(log.append(kSession, study_lines(0, 3)), 3);
  EXPECT_EQ(log.append(kSession, study_lines(3, 6)), 6);
  EXPECT_EQ(lines(), study_lines());
  EXPECT_EQ(table(), whole_table());
  EXPECT_EQ(log.read(kSession), study_lines());
}

TEST_F(SessionLogTest, RefusesGapsAndOtherRecordsOfTheSameNumber) {
  SessionLog log(folder_ / "study");
  log.append(kSession, study_lines(0, 2));
  try {
    log.append(kSession, study_lines(3, 4));
    FAIL();
  } catch (const RecordConflict& conflict) {
    EXPECT_EQ(conflict.next(), 2);
  }
  StudyRecord other = test::study_session()[1];
  other["seconds"] = 12;
  EXPECT_THROW(log.append(kSession, other.dump() + '\n'), RecordConflict);
  EXPECT_EQ(lines(), study_lines(0, 2));
  log.append(kSession, study_lines(2, 6));
  EXPECT_THROW(log.append(kSession, "{\"seq\":6,\"kind\":\"end\"}\n"), RecordConflict);
}

TEST_F(SessionLogTest, OneWrongLineKeepsOutAllThatComeWithIt) {
  SessionLog log(folder_ / "study");
  log.append(kSession, study_lines(0, 1));
  EXPECT_THROW(log.append(kSession, study_lines(1, 3) + "{\"seq\":3,\"kind\":\"secret\"}\n"),
               RefusedRecord);
  EXPECT_THROW(log.append(kSession, study_lines(1, 3) + "{\"seq\":3,\"kind\":\"end\"}"),
               RefusedRecord)
      << "cut off";
  EXPECT_EQ(lines(), study_lines(0, 1));
  EXPECT_THROW(log.append("p008-3f9c2a1b", study_lines(0, 1)), RefusedRecord) << "of participant 7";
}

TEST_F(SessionLogTest, NamesLeadNowhereElse) {
  SessionLog log(folder_ / "study");
  for (const char* name : {"", "p", "p007", "../p007-3f9c2a1b", "p007-3f9c2a1b/..", "p000-3f9c2a1b",
                           "p07-3f9c2a1b", "p0007-3f9c2a1b", "p007-3F9C2A1B", "p007-3f9c2a1bc"}) {
    EXPECT_FALSE(is_session_name(name));
    EXPECT_THROW(log.append(name, study_lines()), RefusedRecord) << name;
    EXPECT_THROW(log.read(name), RefusedRecord) << name;
  }
  EXPECT_TRUE(is_session_name("p1234-00000000"));
}

TEST_F(SessionLogTest, GoesOnWhereAPowerCutLeftALineAndItsTable) {
  {
    SessionLog(folder_ / "study").append(kSession, study_lines(0, 3));
  }
  const std::filesystem::path path = folder_ / "study" / (std::string(kSession) + ".jsonl");
  for (const size_t lost : {1, 20, 100}) {
    write_text(path, study_lines(0, 3).substr(0, study_lines(0, 3).size() - lost));
    SessionLog log(folder_ / "study");
    EXPECT_EQ(log.append(kSession, study_lines(1, 4)), 4);
    EXPECT_EQ(lines(), study_lines(0, 4));
  }
  const std::filesystem::path rows = folder_ / "study" / (std::string(kSession) + ".csv");
  for (const std::string& broken :
       {std::string(), whole_table().substr(0, 300), std::string("seq,what\n1,2\n")}) {
    write_text(rows, broken);
    write_text(path, study_lines(0, 5));
    SessionLog(folder_ / "study").append(kSession, study_lines(5, 6));
    EXPECT_EQ(table(), whole_table());
  }
}

TEST_F(SessionLogTest, AFullDiskLosesNothingAndAddsNothing) {
  SessionLog log(folder_ / "study");
  log.append(kSession, study_lines(0, 2));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit little{study_lines(0, 2).size() + 30, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  EXPECT_THAT([&] { log.append(kSession, study_lines(2, 3)); },
              ThrowsMessage<Error>(HasSubstr("what was recorded stays")));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, ignored);
  EXPECT_EQ(lines(), study_lines(0, 2));
  EXPECT_EQ(log.append(kSession, study_lines(2, 3)), 3);
  EXPECT_EQ(lines(), study_lines(0, 3));
}

TEST_F(SessionLogTest, OneProgramRecordsInAFolder) {
  const SessionLog log(folder_ / "study");
  EXPECT_THAT([&] { SessionLog second(folder_ / "study"); },
              ThrowsMessage<Error>(HasSubstr("at work here")));
}

TEST_F(SessionLogTest, KnowsTheSessionsOfAParticipant) {
  SessionLog log(folder_ / "study");
  EXPECT_TRUE(log.sessions_of(7).empty());
  log.append(kSession, study_lines(0, 6));
  log.append("p007-00000000", study_lines(0, 3));
  const std::vector<SessionSummary> found = log.sessions_of(7);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].session, "p007-00000000");
  EXPECT_EQ(found[0].records, 3);
  EXPECT_FALSE(found[0].ended);
  EXPECT_TRUE(found[1].ended);
  EXPECT_EQ(found[1].plan, "clipgs-vr");
  EXPECT_TRUE(log.sessions_of(8).empty());
}

TEST_F(SessionLogTest, ManyMayRecordAtOnce) {
  SessionLog log(folder_ / "study");
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([&] {
      for (size_t end = 1; end <= 6; ++end) {
        log.append(kSession, study_lines(0, end));
      }
    });
  }
  for (std::thread& writer : writers) {
    writer.join();
  }
  EXPECT_EQ(lines(), study_lines());
  EXPECT_EQ(table(), whole_table());
}

}  // namespace
}  // namespace clipgs
