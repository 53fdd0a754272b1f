#include "study/records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/test_records.h"

namespace clipgs {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

void expect_refused(const StudyRecord& record, const std::string& why) {
  EXPECT_THAT([&] { parse_record(record.dump(), "p007-00000000"); },
              ThrowsMessage<RefusedRecord>(HasSubstr(why)))
      << record.dump();
}

TEST(Records, AreReadInTheirOrder) {
  for (const StudyRecord& record : test::study_session()) {
    StudyRecord turned = StudyRecord::object();
    for (auto field = record.rbegin(); field != record.rend(); ++field) {
      turned[field.key()] = field.value();
    }
    EXPECT_EQ(parse_record(turned.dump(), "").dump(), record.dump());
  }
}

TEST(Records, WhatIsNotAskedForIsRefused) {
  for (const StudyRecord& record : test::study_session()) {
    StudyRecord more = record;
    more["name"] = "Ada";
    expect_refused(more, "has no \"name\"");
  }
}

TEST(Records, WhatIsMissingIsRefused) {
  for (const StudyRecord& record : test::study_session()) {
    for (const auto& [key, value] : record.items()) {
      StudyRecord less = record;
      less.erase(key);
      EXPECT_THROW(parse_record(less.dump(), ""), RefusedRecord) << less.dump();
    }
  }
}

TEST(Records, ValuesOutOfTheirRangesAreRefused) {
  const std::vector<StudyRecord> session = test::study_session();
  const auto expect_wrong = [&](size_t i, const char* key, const StudyRecord& value) {
    StudyRecord record = session[i];
    record[key] = value;
    EXPECT_THROW(parse_record(record.dump(), ""), RefusedRecord) << record.dump();
  };
  expect_wrong(0, "participant", 0);
  expect_wrong(0, "participant", 10'000);
  expect_wrong(0, "participant", "Ada");
  expect_wrong(0, "participant", 7.5);
  expect_wrong(0, "format", 2);
  expect_wrong(0, "order", StudyRecord::array());
  expect_wrong(0, "device", "Ada's headset");
  expect_wrong(0, "plan", "../plan");
  expect_wrong(0, "seq", 1);
  expect_wrong(1, "seq", 0);
  expect_wrong(1, "seconds", -1);
  expect_wrong(1, "seconds", nullptr);
  expect_wrong(1, "seconds", 1e10);
  expect_wrong(1, "outcome", "skipped");
  expect_wrong(1, "regrasps", 1.5);
  expect_wrong(1, "practice", 1);
  expect_wrong(1, "mode", "any angle");
  expect_wrong(2, "answers", {1, 2, 3});
  expect_wrong(2, "answers", {1, 2, 3, 4, 5, 1, 2, 3, 4, 6});
  expect_wrong(2, "answers", {1, 2, 3, 4, 5, 1, 2, 3, 4, 0});
  expect_wrong(2, "answers", {1, 2, 3, 4, 5, 1, 2, 3, 4, 4.5});
  expect_wrong(2, "questionnaire", "efficiency");
  expect_wrong(4, "text", std::string(4001, 'x'));
  expect_wrong(5, "kind", "start");
}

TEST(Records, WhatIsNoRecordIsRefused) {
  for (const char* line : {"", "{", "[]", "null", "{\"seq\":1}", "{\"seq\":\"1\",\"kind\":\"end\"}",
                           "{\"seq\":1e99,\"kind\":\"end\"}", "{\"seq\":1,\"kind\":\"end\"} x"}) {
    EXPECT_THROW(parse_record(line, ""), RefusedRecord) << line;
  }
  EXPECT_THROW(parse_record(std::string(1 << 20, '['), ""), RefusedRecord);
}

TEST(Records, RowsHaveAColumnForEveryField) {
  const std::string header = csv_header_of_records();
  EXPECT_THAT(header, ::testing::StartsWith("seq,kind,format,plan,"));
  const auto columns = std::ranges::count(header, ',');
  for (const StudyRecord& record : test::study_session()) {
    if (record["kind"] != "comment") {
      EXPECT_EQ(std::ranges::count(csv_of_record(record), ','), columns) << record.dump();
    }
  }
  const std::vector<StudyRecord> session = test::study_session();
  EXPECT_THAT(csv_of_record(session[1]), HasSubstr("uniaxial,vessel,false,done,31.25,"));
  EXPECT_THAT(csv_of_record(session[2]), HasSubstr(",sus,5 1 5 1 5 1 5 1 5 1"));
  EXPECT_THAT(csv_of_record(session[4]), ::testing::EndsWith(",\"a \"\"fine\"\" tool, this\""));
}

}  // namespace
}  // namespace clipgs
