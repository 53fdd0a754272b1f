#include "serve/companion_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "core/file.h"
#include "serve/site.h"
#include "serve/test_cases.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kMarks = "/cases/head.marks.json";
constexpr const char* kTour = "/cases/head.tour.json";
constexpr const char* kNew = "Content-Type: application/json\r\nIf-None-Match: *\r\n";

std::string marks_file(const std::string& name) {
  return R"({"clipgs_marks":1,"volume":"","marks":[{"id":"a","kind":"point","name":")" + name +
         R"(","points":[[1,2,3]]}]})";
}

std::string etag_in(const std::string& answer) {
  const size_t at = answer.find("ETag: ");
  return at == std::string::npos ? "" : answer.substr(at + 6, answer.find('\r', at) - at - 6);
}

std::string known(const std::string& etag) {
  return "Content-Type: application/json\r\nIf-Match: " + etag + "\r\n";
}

class CompanionDeskTest : public ::testing::Test {
 protected:
  CompanionDeskTest() { test::write_small_case(folder_ / "head.sog", "A head"); }

  Site open_site(bool keeps = true) {
    SiteOptions options{folder_.path(), "", "localhost", "http://127.0.0.1:8080/"};
    options.keeps.marks = keeps;
    return Site(std::move(options));
  }
  static std::string get(Site& site, const std::string& target, const std::string& headers = "") {
    return site.answer_bytes("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers +
                             "\r\n");
  }
  static std::string put(Site& site, const std::string& target, const std::string& body,
                         const std::string& headers) {
    return site.answer_bytes("PUT " + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers +
                             "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body);
  }

  const TestFolder folder_;
};

TEST_F(CompanionDeskTest, KeepsMarksBesideTheirCase) {
  Site site = open_site();
  EXPECT_THAT(get(site, "/api/cases"), HasSubstr(R"("keeps_marks":true)"));
  EXPECT_THAT(get(site, kMarks), StartsWith("HTTP/1.1 204"));
  const std::string first = put(site, kMarks, marks_file("one"), kNew);
  EXPECT_THAT(first, StartsWith("HTTP/1.1 204"));
  const std::string there = get(site, kMarks);
  EXPECT_THAT(there, AllOf(StartsWith("HTTP/1.1 200"), EndsWith(marks_file("one"))));
  EXPECT_EQ(etag_in(there), etag_in(first));
  EXPECT_EQ(read_text(folder_ / "head.marks.json"), marks_file("one"));
  EXPECT_THAT(get(site, kMarks, "If-None-Match: " + etag_in(first) + "\r\n"),
              StartsWith("HTTP/1.1 304"));
  EXPECT_THAT(put(site, kMarks, marks_file("two"), known(etag_in(first))),
              StartsWith("HTTP/1.1 204"));
  EXPECT_THAT(get(site, kMarks), EndsWith(marks_file("two")));
}

TEST_F(CompanionDeskTest, KeepsToursBesideMarksWhereToldTo) {
  const std::string tour =
      R"({"clipgs_tour":1,"volume":"","stops":[{"id":"a","show":"view=30,20","fly":3,"stay":5}]})";
  const std::string file = "Content-Type: application/json\r\nIf-None-Match: *\r\n";
  Site marks_alone = open_site();
  EXPECT_THAT(get(marks_alone, "/api/cases"), HasSubstr(R"("keeps_tours":false)"));
  EXPECT_THAT(put(marks_alone, kTour, tour, file), StartsWith("HTTP/1.1 405"));
  SiteOptions options{folder_.path(), "", "localhost", "http://127.0.0.1:8080/"};
  options.keeps.tours = true;
  Site site(std::move(options));
  EXPECT_THAT(get(site, "/api/cases"),
              AllOf(HasSubstr(R"("keeps_tours":true)"), HasSubstr(R"("keeps_marks":false)")));
  EXPECT_THAT(get(site, kTour), StartsWith("HTTP/1.1 204"));
  EXPECT_THAT(put(site, kTour, tour, file), StartsWith("HTTP/1.1 204"));
  EXPECT_THAT(get(site, kTour), AllOf(StartsWith("HTTP/1.1 200"), EndsWith(tour)));
  EXPECT_THAT(get(site, kMarks), StartsWith("HTTP/1.1 204")) << "another file";
  EXPECT_THAT(put(site, kMarks, marks_file("one"), kNew), StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(put(site, kTour, marks_file("one"), kNew),
              AllOf(StartsWith("HTTP/1.1 422"), HasSubstr("no file of tours of version 1")));
  EXPECT_EQ(read_text(folder_ / "head.tour.json"), tour);
}

TEST_F(CompanionDeskTest, WhoseMarksAreOlderChangesNothing) {
  Site site = open_site();
  const std::string first = etag_in(put(site, kMarks, marks_file("one"), kNew));
  EXPECT_THAT(put(site, kMarks, marks_file("x"), kNew), StartsWith("HTTP/1.1 412"));
  put(site, kMarks, marks_file("two"), known(first));
  EXPECT_THAT(put(site, kMarks, marks_file("x"), known(first)),
              AllOf(StartsWith("HTTP/1.1 412"), HasSubstr("read them again")));
  EXPECT_THAT(put(site, kMarks, marks_file("x"), "Content-Type: application/json\r\n"),
              StartsWith("HTTP/1.1 412"));
  EXPECT_THAT(get(site, kMarks), EndsWith(marks_file("two")));
  fs::remove(folder_ / "head.marks.json");
  EXPECT_THAT(put(site, kMarks, marks_file("x"), known(first)), StartsWith("HTTP/1.1 412"));
}

TEST_F(CompanionDeskTest, OnlyGivesThemWhereNotToldToKeepThem) {
  write_text(folder_ / "head.marks.json", marks_file("one"));
  Site site = open_site(false);
  EXPECT_THAT(get(site, "/api/cases"), HasSubstr(R"("keeps_marks":false)"));
  EXPECT_THAT(get(site, kMarks), EndsWith(marks_file("one")));
  EXPECT_THAT(put(site, kMarks, marks_file("x"), kNew), StartsWith("HTTP/1.1 405"));
  EXPECT_EQ(read_text(folder_ / "head.marks.json"), marks_file("one"));
}

TEST_F(CompanionDeskTest, TakesNothingElse) {
  Site site = open_site();
  for (const std::string& body :
       {std::string(), std::string("{}"), std::string("[1]"), std::string("{\"clipgs_marks\":1}"),
        std::string(R"({"clipgs_marks":2,"marks":[]})"), std::string("\xff\xfe")}) {
    EXPECT_THAT(put(site, kMarks, body, kNew), StartsWith("HTTP/1.1 422")) << body;
  }
  std::string many = R"({"clipgs_marks":1,"marks":[0)";
  for (int i = 0; i < 500; ++i) {
    many += ",0";
  }
  EXPECT_THAT(put(site, kMarks, many + "]}", kNew),
              AllOf(StartsWith("HTTP/1.1 422"), HasSubstr("501 marks are more than the 500")));
  EXPECT_THAT(put(site, kMarks, std::string(300 << 10, ' '), kNew), StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(put(site, "/cases/other.marks.json", marks_file("x"), kNew),
              StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(put(site, "/cases/..%2Fhead.marks.json", marks_file("x"), kNew),
              StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(put(site, "/cases/head.sog", marks_file("x"), kNew), StartsWith("HTTP/1.1 405"));
  EXPECT_FALSE(fs::exists(folder_ / "head.marks.json"));
}

TEST_F(CompanionDeskTest, TakesThemFromItsOwnPagesAlone) {
  Site site = open_site();
  const std::string site_of = "If-None-Match: *\r\nSec-Fetch-Site: ";
  EXPECT_THAT(put(site, kMarks, marks_file("x"),
                  site_of + "cross-site\r\nContent-Type: application/json\r\n"),
              StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(put(site, kMarks, marks_file("x"), site_of + "same-origin\r\n"),
              StartsWith("HTTP/1.1 403"))
      << "a form";
  EXPECT_THAT(put(site, kMarks, marks_file("x"),
                  site_of + "same-origin\r\nContent-Type: application/json\r\n"),
              StartsWith("HTTP/1.1 204"));
}

TEST_F(CompanionDeskTest, FollowsNoLinkOutOfTheFolder) {
  const fs::path secret = folder_ / "elsewhere" / "secret.json";
  fs::create_directory(secret.parent_path());
  write_text(secret, marks_file("secret"));
  fs::create_symlink(secret, folder_ / "head.marks.json");
  Site site = open_site();
  EXPECT_THAT(get(site, kMarks), AllOf(StartsWith("HTTP/1.1 503"), Not(HasSubstr("secret"))));
  EXPECT_THAT(put(site, kMarks, marks_file("x"), kNew), StartsWith("HTTP/1.1 503"));
  EXPECT_EQ(read_text(secret), marks_file("secret"));
}

TEST_F(CompanionDeskTest, SaysWhereTheyCannotBeWritten) {
  Site site = open_site();
  const std::string before = etag_in(put(site, kMarks, marks_file("one"), kNew));
  const fs::perms perms = fs::status(folder_.path()).permissions();
  fs::permissions(folder_.path(), fs::perms::owner_read | fs::perms::owner_exec);
  const bool is_root = ::access(folder_.path().c_str(), W_OK) == 0;
  const std::string answer = put(site, kMarks, marks_file("two"), known(before));
  fs::permissions(folder_.path(), perms);
  if (is_root) {
    GTEST_SKIP() << "the superuser may write anywhere";
  }
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 507"), HasSubstr("head.marks.json cannot be"),
                            Not(HasSubstr(folder_.path().string()))));
  EXPECT_EQ(read_text(folder_ / "head.marks.json"), marks_file("one"));
}

}  // namespace
}  // namespace clipgs
