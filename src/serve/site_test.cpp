#include "serve/site.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "serve/test_cases.h"
#include "serve/viewer_bundle.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kToken = "k3v9q-txw7h-23456-abcde-fghijk";

class SiteTest : public ::testing::Test {
 protected:
  SiteTest() { test::write_small_case(folder_ / "head.sog", "A head"); }

  Site open_site(const std::string& token = "") {
    return Site({folder_.path(), token,
                 token.empty() ? std::optional<std::string>("machine") : std::nullopt,
                 "http://127.0.0.1:8080/"});
  }
  /// What the site answers a GET of `target` with those headers, lines that end in "\r\n".
  static std::string get(Site& site, const std::string& target,
                         const std::string& headers = "Host: localhost\r\n") {
    return site.answer_bytes("GET " + target + " HTTP/1.1\r\n" + headers + "\r\n");
  }
  static Answer answer(Site& site, const std::string& target, const std::string& cookie = "") {
    HttpRequest request(boost::beast::http::verb::get, target, 11);
    if (!cookie.empty()) {
      request.set(boost::beast::http::field::cookie, cookie);
    }
    return site.answer(request, {"client", "client"});
  }

  const TestFolder folder_;
};

TEST_F(SiteTest, AnswersTheNamesOfThisMachineAlone) {
  Site site = open_site();
  for (const char* host :
       {"localhost", "LOCALHOST", "localhost.", "LocalHost:8080", "127.0.0.1", "127.0.0.1:80",
        "127.255.0.3", "[::1]", "[::1]:8080", "[0:0:0:0:0:0:0:1]", "[::ffff:127.0.0.1]:1",
        "machine", "MACHINE:8080", "127.0.0.1."}) {
    EXPECT_THAT(get(site, "/api/cases", "Host: " + std::string(host) + "\r\n"),
                StartsWith("HTTP/1.1 200"))
        << host;
  }
  for (const char* host : {"127.evil.com",
                           "127.0.0.1.evil.com",
                           "[::1].evil.com",
                           "[::1]evil.com",
                           "[::1",
                           "localhost.evil.com",
                           "evil.localhost.com",
                           "localhost..",
                           "localhost@evil.com",
                           "evil.com@localhost",
                           "127.0.0.1@evil.com",
                           "user:pass@localhost",
                           "127.0.0.1:80@evil.com",
                           "0x7f.1",
                           "0x7f000001",
                           "2130706433",
                           "127.1",
                           "0177.0.0.1",
                           "127.0.0.1.1",
                           "128.0.0.1",
                           "0.0.0.0",
                           "[::]",
                           "[::2]",
                           "[fe80::1%lo]",
                           "[::ffff:128.0.0.1]",
                           "[127.0.0.1]",
                           "localhost:99999",
                           "localhost:x",
                           "localhost:80:80",
                           "localhost:-1",
                           "localhost:+1",
                           "localhost, evil.com",
                           "localhost/evil.com",
                           "evil.example",
                           "",
                           ":8080",
                           "::1",
                           "machine.evil.com"}) {
    EXPECT_THAT(get(site, "/api/cases", "Host: " + std::string(host) + "\r\n"),
                AllOf(StartsWith("HTTP/1.1 403"), HasSubstr("http://127.0.0.1:8080/")))
        << host;
  }
  EXPECT_THAT(get(site, "/api/cases", ""), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get(site, "/api/cases", "Host: localhost\r\nHost: evil.com\r\n"),
              StartsWith("HTTP/1.1 403"));
}

TEST_F(SiteTest, RefusesWhatIsNoRequest) {
  Site site = open_site();
  EXPECT_EQ(site.answer_bytes("GET / HTTP/1.1\r\nHost: localhost\r\n"), "") << "goes on";
  EXPECT_THAT(site.answer_bytes("\x16\x03\x01\x02 is TLS\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(site.answer_bytes("GET / HTTP/9.9\r\n\r\n"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get(site, "http://localhost/api/cases"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get(site, "/%zz"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get(site, "/%4"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get(site, "*"), StartsWith("HTTP/1.1 400"));
  EXPECT_THAT(get(site, "/", "X: " + std::string(20'000, 'x') + "\r\n"),
              AllOf(StartsWith("HTTP/1.1 431"), HasSubstr("Connection: close")));
}

TEST_F(SiteTest, ABodyEndsTheConnection) {
  Site site = open_site();
  EXPECT_THAT(get(site, "/api/cases"), Not(HasSubstr("Connection: close")));
  for (const char* headers :
       {"Content-Length: 5\r\n", "Transfer-Encoding: chunked\r\n", "Connection: close\r\n"}) {
    EXPECT_THAT(get(site, "/api/cases", std::string("Host: localhost\r\n") + headers),
                AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("Connection: close")))
        << headers;
  }
  EXPECT_THAT(site.answer_bytes("POST /api/cases HTTP/1.1\r\nHost: localhost\r\n\r\n"),
              AllOf(StartsWith("HTTP/1.1 405"), HasSubstr("Connection: close"),
                    HasSubstr("Allow: GET, HEAD")));
}

TEST_F(SiteTest, HeadersAloneSayWhatABodyWouldBe) {
  Site site = open_site();
  const std::string whole = get(site, "/cases/head.sog");
  const std::string head =
      site.answer_bytes("HEAD /cases/head.sog HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(head, whole.substr(0, whole.find("\r\n\r\n") + 4));
  EXPECT_THAT(head, HasSubstr("Content-Length: " +
                              std::to_string(std::filesystem::file_size(folder_ / "head.sog"))));
}

TEST_F(SiteTest, PagesElsewhereMayNotFrameIt) {
  Site site = open_site();
  for (const char* path : {"/", "/api/cases", "/nowhere"}) {
    EXPECT_THAT(get(site, path),
                AllOf(HasSubstr("frame-ancestors 'self'"), HasSubstr("base-uri 'none'"),
                      HasSubstr("object-src 'none'"), HasSubstr("form-action 'none'")))
        << path;
  }
}

TEST_F(SiteTest, TheTokenMayBeTypedInCapitalsAndWithoutStrokes) {
  Site site = open_site(kToken);
  for (const char* path : {"/k3v9q-txw7h-23456-abcde-fghijk", "/K3V9Q-TXW7H-23456-ABCDE-FGHIJK",
                           "/k3v9qtxw7h23456abcdefghijk"}) {
    EXPECT_THAT(get(site, path),
                AllOf(StartsWith("HTTP/1.1 302"),
                      HasSubstr("Set-Cookie: __Host-clipgs=" + std::string(kToken))))
        << path;
  }
  EXPECT_THAT(get(site, "/k3v9q-txw7h-23456-abcde-fghij"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(get(site, "/"), AllOf(StartsWith("HTTP/1.1 403"), Not(HasSubstr(kToken))));
}

TEST_F(SiteTest, WrongTokensWaitAndTheRightOneDoesNot) {
  Site site = open_site(kToken);
  int late = 0;
  for (int i = 0; i < 50; ++i) {
    const Answer wrong = i % 2 == 0
                             ? answer(site, "/k3v9q-txw7h-23456-abcde-fghij" + std::to_string(i))
                             : answer(site, "/", "__Host-clipgs=wrong");
    EXPECT_EQ(wrong.head.result_int(), wrong.delay.count() > 0 ? 429U : 403U);
    EXPECT_EQ(wrong.last, wrong.delay.count() > 0);
    late += wrong.delay.count() >= 1000 ? 1 : 0;
  }
  EXPECT_GE(late, 38);
  const Answer right = answer(site, std::string("/") + kToken);
  EXPECT_EQ(right.head.result_int(), 302U);
  EXPECT_EQ(right.delay.count(), 0);
  const Answer known = answer(site, "/api/cases", std::string("__Host-clipgs=") + kToken);
  EXPECT_EQ(known.head.result_int(), 200U);
  EXPECT_EQ(known.delay.count(), 0);
  EXPECT_EQ(answer(site, "/").head.result_int(), 403U) << "is no try";
}

TEST_F(SiteTest, AFolderThatVanishedIsSaid) {
  Site site = open_site();
  std::filesystem::remove_all(folder_.path());
  for (const char* path : {"/api/cases", "/cases/head.sog", "/cases/head/thumbnail"}) {
    EXPECT_THAT(get(site, path),
                AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("Content-Type: text/plain"),
                      HasSubstr("\r\n\r\nthe folder of the cases cannot be read")))
        << path;
  }
}

TEST_F(SiteTest, ScriptsAndStylesAreSentCompressed) {
  if (viewer_files().empty()) {
    GTEST_SKIP() << "built without the viewer";
  }
  Site site = open_site();
  size_t plain = 0;
  size_t sent = 0;
  for (const ViewerFile& file : viewer_files()) {
    const std::string path = '/' + std::string(file.path);
    const bool small = file.brotli.empty();
    const auto with = [&](const std::string& encodings) {
      return get(site, path, "Host: localhost\r\nAccept-Encoding: " + encodings + "\r\n");
    };
    const auto body = [](const std::string& text) {
      return text.substr(text.find("\r\n\r\n") + 4);
    };
    const std::string browser = with("gzip, deflate, br, zstd");
    if (!file.path.ends_with(".glb")) {  // models are dense already
      plain += file.bytes.size();
      sent += body(browser).size();
    }
    EXPECT_EQ(body(with("identity")), file.bytes) << path;
    if (small) {
      EXPECT_THAT(browser, Not(HasSubstr("Content-Encoding"))) << path;
      continue;
    }
    EXPECT_EQ(body(browser), file.brotli) << path;
    EXPECT_THAT(browser,
                AllOf(HasSubstr("Content-Encoding: br"), HasSubstr("Vary: Accept-Encoding")));
    EXPECT_EQ(body(with("gzip, deflate")), file.gzip) << path;
    EXPECT_THAT(with("gzip;q=0.5, br;q=0"), HasSubstr("Content-Encoding: gzip"));
    // Each form has its own ETag.
    const auto etag = [](const std::string& text) {
      const size_t begin = text.find("ETag: ") + 6;
      return text.substr(begin, text.find("\r\n", begin) - begin);
    };
    EXPECT_NE(etag(browser), etag(with("gzip")));
    EXPECT_THAT(with("br\r\nIf-None-Match: " + etag(browser)), StartsWith("HTTP/1.1 304"));
    EXPECT_THAT(with("gzip\r\nIf-None-Match: " + etag(browser)), StartsWith("HTTP/1.1 200"));
  }
  EXPECT_LT(sent, plain / 3);
}

TEST_F(SiteTest, TellsPagesWhatIsMadeAndHearsOfThem) {
  test::write_small_case(folder_ / "foot.sog", "A foot");
  LiveWork live;
  live.begin("head", "standard", [] { return std::optional(61.2); });
  Site site({folder_.path(), "", "machine", "http://127.0.0.1:8080/", {}, {"head"}, &live});
  const std::string first = get(site, "/api/cases?page=a1");
  EXPECT_THAT(first, HasSubstr(R"("making":[{"name":"head","quality":"standard","seconds":61}])"));
  EXPECT_THAT(first, AllOf(HasSubstr("A head"), Not(HasSubstr("A foot")), HasSubstr("version")));
  EXPECT_THAT(get(site, "/cases/foot.sog"), StartsWith("HTTP/1.1 404"));
  EXPECT_FALSE(live.deserted());
  get(site, "/api/cases?page=a1&left");
  EXPECT_TRUE(live.deserted());
}

}  // namespace
}  // namespace clipgs
