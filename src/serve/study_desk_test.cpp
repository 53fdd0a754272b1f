#include "serve/study_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "serve/site.h"
#include "serve/test_cases.h"
#include "study/built_in_plans.h"
#include "study/test_records.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using test::study_lines;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kSession = "/api/study/sessions/p007-3f9c2a1b";

class StudyDeskTest : public ::testing::Test {
 protected:
  StudyDeskTest() { test::write_small_case(folder_ / "cases.sog", "A head"); }

  Site open_site(bool study = true) {
    SiteOptions options{folder_.path(), "", "localhost", "http://127.0.0.1:8080/"};
    options.study = study ? folder_ / "study" : std::filesystem::path();
    return Site(std::move(options));
  }
  static std::string get(Site& site, const std::string& target) {
    return site.answer_bytes("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }
  static std::string post(Site& site, const std::string& target, const std::string& body,
                          const std::string& headers = "Content-Type: application/jsonl\r\n") {
    return site.answer_bytes("POST " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers +
                             "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }

  const TestFolder folder_;
};

TEST_F(StudyDeskTest, TakesRecordsAndGivesThemBack) {
  Site site = open_site();
  EXPECT_THAT(post(site, kSession, study_lines(0, 2)),
              AllOf(StartsWith("HTTP/1.1 200"), EndsWith("{\"records\":2}"),
                    Not(HasSubstr("Connection: close"))));
  EXPECT_THAT(post(site, kSession, study_lines(0, 3)), EndsWith("{\"records\":3}"));
  EXPECT_THAT(get(site, kSession), EndsWith("\r\n\r\n" + study_lines(0, 3)));
  EXPECT_THAT(
      get(site, "/api/study/sessions?participant=7"),
      EndsWith(R"([{"ended":false,"plan":"clipgs-vr","records":3,"session":"p007-3f9c2a1b"}])"));
  EXPECT_THAT(get(site, "/api/study/sessions?participant=8"), EndsWith("\r\n\r\n[]"));
  EXPECT_THAT(get(site, "/api/study/sessions?participant=x"), StartsWith("HTTP/1.1 400"));
}

TEST_F(StudyDeskTest, SaysWhereASessionGoesOn) {
  Site site = open_site();
  post(site, kSession, study_lines(0, 2));
  EXPECT_THAT(post(site, kSession, study_lines(4, 5)),
              AllOf(StartsWith("HTTP/1.1 409"), HasSubstr("\"records\":2"),
                    HasSubstr("record 2 is missing")));
  EXPECT_THAT(post(site, kSession, "{\"seq\":2}\n"), StartsWith("HTTP/1.1 422"));
  EXPECT_THAT(post(site, "/api/study/sessions/..%2Fp007-3f9c2a1b", study_lines()),
              StartsWith("HTTP/1.1 422"));
  EXPECT_THAT(get(site, "/api/study/sessions/p007"), StartsWith("HTTP/1.1 422"));
  EXPECT_THAT(post(site, "/api/study/sessionsx", study_lines()), StartsWith("HTTP/1.1 404"));
}

TEST_F(StudyDeskTest, RecordsComeFromItsOwnPagesAlone) {
  Site site = open_site();
  for (const char* headers :
       {"Content-Type: text/plain\r\n", "",
        "Content-Type: application/jsonl\r\nSec-Fetch-Site: cross-site\r\n"}) {
    EXPECT_THAT(post(site, kSession, study_lines(), headers), StartsWith("HTTP/1.1 403"))
        << headers;
  }
  EXPECT_THAT(get(site, kSession), EndsWith("\r\n\r\n")) << "nothing was recorded";
}

TEST_F(StudyDeskTest, NoMoreIsTakenThanASessionMaySend) {
  Site site = open_site();
  EXPECT_THAT(post(site, kSession, std::string(300'000, 'x')),
              AllOf(StartsWith("HTTP/1.1 413"), HasSubstr("Connection: close")));
  EXPECT_EQ(site.answer_bytes("POST " + std::string(kSession) +
                              " HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\nabc"),
            "")
      << "goes on";
}

TEST_F(StudyDeskTest, ARequestWithoutABodyBringsNothing) {
  Site site = open_site();
  const std::string headers = " HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/jsonl\r\n";
  EXPECT_THAT(site.answer_bytes("POST " + std::string(kSession) + headers + "\r\nabc"),
              StartsWith("HTTP/1.1 422"));
}

TEST_F(StudyDeskTest, AFullDiskIsSaid) {
  Site site = open_site();
  // A file that cannot be appended to stands for it.
  std::filesystem::create_directory(folder_ / "study/p007-3f9c2a1b.jsonl");
  EXPECT_THAT(post(site, kSession, study_lines()),
              AllOf(StartsWith("HTTP/1.1 507"), HasSubstr("p007-3f9c2a1b")));
}

TEST_F(StudyDeskTest, GivesPlansOfTheFolderAndOfTheProgram) {
  Site site = open_site();
  EXPECT_THAT(get(site, "/study/clipgs-vr.json"),
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("One axis against any angle")));
  write_text(folder_ / "study/clipgs-vr.json", "{\"mine\": true}");
  EXPECT_THAT(get(site, "/study/clipgs-vr.json"), EndsWith("{\"mine\": true}"));
  for (const char* path :
       {"/study/none.json", "/study/..%2Fcases.json", "/study/", "/study/clipgs-vr",
        "/study/p007-3f9c2a1b.jsonl", "/study/clipgs.lock"}) {
    EXPECT_THAT(get(site, path), StartsWith("HTTP/1.1 404")) << path;
  }
  ASSERT_FALSE(built_in_plans().empty());
  for (const BuiltInPlan& plan : built_in_plans()) {
    EXPECT_EQ(nlohmann::json::parse(plan.json)["name"], std::string(plan.name));
  }
}

TEST_F(StudyDeskTest, WithoutAStudyNothingIsTaken) {
  Site site = open_site(false);
  EXPECT_THAT(post(site, kSession, study_lines()),
              AllOf(StartsWith("HTTP/1.1 405"), HasSubstr("Connection: close")));
  EXPECT_THAT(get(site, "/study/clipgs-vr.json"),
              AllOf(StartsWith("HTTP/1.1 404"), HasSubstr("--study")));
}

}  // namespace
}  // namespace clipgs
