#include "serve/overview_desk.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "measure/overview_page.h"
#include "serve/site.h"
#include "serve/test_cases.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class OverviewDeskTest : public testing::Test {
 protected:
  OverviewDeskTest() {
    test::write_small_case(folder_ / "a b.sog", "A case");
    write_overview(folder_.path());
    write_text(folder_ / "overview" / "notes.txt", "secret");
    write_text(folder_ / "secret.html", "secret");
  }

  std::string get(const std::string& target, std::set<std::string> only = {}) const {
    SiteOptions options{folder_.path(), "", "localhost", "http://127.0.0.1:8080/"};
    options.only = std::move(only);
    Site site(std::move(options));
    return site.answer_bytes("GET " + target + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  }

  const TestFolder folder_;
};

TEST_F(OverviewDeskTest, GivesThePageWithItsScriptAloneAllowed) {
  const std::string page = get("/overview/");
  EXPECT_THAT(page, AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("Content-Type: text/html"),
                          HasSubstr("script-src 'sha256-"), HasSubstr("a%20b.webp")));
  EXPECT_EQ(page.find("Content-Security-Policy"), page.rfind("Content-Security-Policy"));
  EXPECT_THAT(page, HasSubstr(std::string(overview_script())));
  EXPECT_THAT(get("/overview"), AllOf(StartsWith("HTTP/1.1 301"), HasSubstr("/overview/\r\n")));
  EXPECT_THAT(get("/overview/a%20b.webp"),
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("image/webp")));
}

TEST_F(OverviewDeskTest, GivesNothingElse) {
  for (const char* const path :
       {"/overview/notes.txt", "/overview/../secret.html", "/overview/..%2fsecret.html",
        "/overview/.html", "/overview/absent.html", "/overview/a%00.html", "/overviews"}) {
    EXPECT_THAT(get(path), AllOf(StartsWith("HTTP/1.1 404"), Not(HasSubstr("secret")))) << path;
  }
  std::filesystem::create_symlink(folder_ / "secret.html", folder_ / "overview" / "led.html");
  EXPECT_THAT(get("/overview/led.html"), Not(HasSubstr("secret\n")));
  EXPECT_THAT(get("/overview/led.html"), Not(StartsWith("HTTP/1.1 200")));
}

TEST_F(OverviewDeskTest, WhereOnlySomeCasesAreServedThereIsNone) {
  EXPECT_THAT(get("/overview/", {"a b"}), StartsWith("HTTP/1.1 404"));
}

}  // namespace
}  // namespace clipgs
