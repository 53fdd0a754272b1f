#include "archive/series_records.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

class SeriesRecordsTest : public ::testing::Test {
 protected:
  SeriesRecordsTest()
      : folder_(fs::path(::testing::TempDir()) / ("clipgs-records-" + std::to_string(::getpid()))) {
  }
  ~SeriesRecordsTest() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(SeriesRecordsTest, KeepsWhatWasWritten) {
  std::string name;
  {
    const SeriesRecords records(folder_);
    name = records.name_of("series");
    EXPECT_FALSE(records.read(name));
    records.write(name, {SeriesStage::kPutBack, "lungs", "l", "c", 3, 1234567890123, "why"});
  }
  const SeriesRecords records(folder_);
  EXPECT_EQ(records.name_of("series"), name);
  const auto record = records.read(name);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->stage, SeriesStage::kPutBack);
  EXPECT_EQ(record->rule, "lungs");
  EXPECT_EQ(record->listing, "l");
  EXPECT_EQ(record->content, "c");
  EXPECT_EQ(record->tries, 3);
  EXPECT_EQ(record->next_try, 1234567890123);
  EXPECT_EQ(record->reason, "why");
}

TEST_F(SeriesRecordsTest, NamesFollowFromASecret) {
  std::string name;
  {
    const SeriesRecords records(folder_);
    name = records.name_of("series");
    EXPECT_EQ(name.size(), 16U);
    EXPECT_NE(name, records.name_of("series2"));
  }
  fs::remove(folder_ / "secret");
  EXPECT_NE(SeriesRecords(folder_).name_of("series"), name);
}

TEST_F(SeriesRecordsTest, LetsOneProcessIn) {
  const SeriesRecords records(folder_);
  EXPECT_THROW(SeriesRecords second(folder_), Error);
  EXPECT_EQ(fs::status(folder_).permissions(), fs::perms::owner_all);
}

TEST_F(SeriesRecordsTest, SweepsWhatAKilledProcessLeft) {
  for (const char* const name : {"working", "over"}) {
    fs::create_directories(folder_ / name / "images");
    fs::create_directories(folder_ / name / "work");
  }
  {
    const SeriesRecords records(folder_);
    records.write("working", {SeriesStage::kBuild, "r", "l"});
    records.write("over", {SeriesStage::kDone, "r", "l"});
  }
  const SeriesRecords records(folder_);
  EXPECT_FALSE(fs::exists(folder_ / "working" / "images"));
  EXPECT_TRUE(fs::exists(folder_ / "working" / "work"));
  EXPECT_FALSE(fs::exists(folder_ / "over"));
}

TEST_F(SeriesRecordsTest, TakesABrokenRecordForNone) {
  const SeriesRecords records(folder_);
  for (const char* const text : {"{", "[]", R"({"stage": "dancing"})", R"({"stage": 3})", ""}) {
    write_text(folder_ / "name.json", text);
    EXPECT_FALSE(records.read("name")) << text;
  }
}

TEST_F(SeriesRecordsTest, ForgetsFailuresAlone) {
  const SeriesRecords records(folder_);
  records.write("failed", {SeriesStage::kFailed, "r", "l"});
  records.write("done", {SeriesStage::kDone, "r", "l"});
  records.forget_failures();
  EXPECT_FALSE(records.read("failed"));
  EXPECT_TRUE(records.read("done"));
}

}  // namespace
}  // namespace clipgs
