#include "archive/http_client.h"

#include <atomic>
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>
#include <unistd.h>

#include "archive/orthanc_fixture.h"
#include "archive/test_sockets.h"

#include "volume/test_folder.h"

namespace clipgs {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::connect_to;
using testing_support::free_port;
using testing_support::make_tls_gate;
using testing_support::read_head;
using testing_support::send_all;
using testing_support::SocketServer;
using testing_support::TestAuthority;
using testing_support::tunnel;

constexpr const char* kGood = "HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\nok";

/// Sends the same to everybody, and keeps the heads of what came.
class Answers {
 public:
  explicit Answers(std::vector<std::string> answers)
      : answers_(std::move(answers)), server_([this](int socket) { serve(socket); }) {}

  std::string url() const { return fmt::format("http://127.0.0.1:{}", server_.port()); }
  int port() const { return server_.port(); }
  std::vector<std::string> heads() {
    const std::scoped_lock lock(mutex_);
    return heads_;
  }

 private:
  void serve(int socket) {
    const std::string head = read_head(socket);
    std::string answer;
    {
      const std::scoped_lock lock(mutex_);
      answer = answers_[std::min(heads_.size(), answers_.size() - 1)];
      heads_.push_back(head);
    }
    send_all(socket, answer);
  }

  std::vector<std::string> answers_;
  std::mutex mutex_;
  std::vector<std::string> heads_;
  SocketServer server_;
};

HttpOptions quick() {
  HttpOptions options;
  options.first_wait = milliseconds(5);
  options.connect_limit = milliseconds(500);
  options.idle_limit = milliseconds(300);
  return options;
}

std::string error_of_get(const std::string& url, const HttpOptions& options = quick()) {
  return error_of([&] { HttpClient(url, options).get("/x", "*/*"); });
}

TEST(HttpClient, AsksAgainWhereThatMayHelp) {
  Answers busy({"HTTP/1.1 503 Busy\r\nContent-Length: 0\r\n\r\n",
                "HTTP/1.1 429 Often\r\nRetry-After: 0\r\n\r\n", "HTTP/1.1 200 OK\r\nContent-Len",
                kGood});
  EXPECT_EQ(HttpClient(busy.url() + "/a", quick()).get("/b", "text/plain").body, "ok");
  ASSERT_EQ(busy.heads().size(), 4U);
  EXPECT_THAT(busy.heads()[3],
              AllOf(HasSubstr("GET /a/b HTTP/1.1"), HasSubstr("Accept: text/plain")));

  Answers never({"HTTP/1.1 500 Broken\r\n\r\n"});
  EXPECT_THAT(error_of_get(never.url()), HasSubstr("cannot do that now (500)"));
  EXPECT_EQ(never.heads().size(), 4U);
  EXPECT_NE(error_of([&] { HttpClient(never.url(), quick()).post("/x", {"text/plain", "1"}); }),
            "");
  EXPECT_EQ(never.heads().size(), 5U) << "what may change something is asked once";

  Answers wrong({"HTTP/1.1 404 Nothing\r\n\r\n"});
  EXPECT_THAT(error_of_get(wrong.url()), HasSubstr("has nothing there (404)"));
  EXPECT_EQ(wrong.heads().size(), 1U);
}

TEST(HttpClient, SendsWhatIsStored) {
  Answers server({kGood, "HTTP/1.1 204 Done\r\n\r\n"});
  HttpClient client(server.url(), quick());
  EXPECT_EQ(client.put("/x", {"application/json", "{}"}).body, "ok");
  EXPECT_EQ(client.del("/x").head.status, 204);
  EXPECT_THAT(server.heads()[0], AllOf(HasSubstr("PUT /x"), HasSubstr("Content-Length: 2\r\n"),
                                       HasSubstr("Content-Type: application/json")));
  EXPECT_THAT(server.heads()[1], HasSubstr("DELETE /x"));
}

TEST(HttpClient, ARedirectTellsNobodyElseWhoAsks) {
  Answers other({kGood});
  Answers first({fmt::format("HTTP/1.1 302 There\r\nLocation: {}/there\r\n\r\n", other.url())});
  HttpOptions options = quick();
  options.token = "very-secret";
  EXPECT_EQ(HttpClient(first.url(), options).get("/x", "*/*").body, "ok");
  EXPECT_THAT(first.heads().at(0), HasSubstr("Authorization: Bearer very-secret"));
  EXPECT_THAT(other.heads().at(0), AllOf(HasSubstr("GET /there"), Not(HasSubstr("secret")),
                                         Not(HasSubstr("Authorization"))));

  Answers same({"HTTP/1.1 307 There\r\nLocation: /there\r\n\r\n", kGood});
  EXPECT_EQ(HttpClient(same.url(), options).get("/x", "*/*").body, "ok");
  EXPECT_THAT(same.heads().at(1), HasSubstr("very-secret"));

  Answers circle({"HTTP/1.1 301 There\r\nLocation: /x\r\n\r\n"});
  EXPECT_THAT(error_of_get(circle.url()), HasSubstr("from one address to the next"));
  Answers nowhere({"HTTP/1.1 301 There\r\n\r\n"});
  EXPECT_NE(error_of_get(nowhere.url()), "");
}

TEST(HttpClient, SaysInOneLineWhatIsWrongAndNoSecret) {
  HttpOptions options = quick();
  options.user = "me";
  options.password = "very-secret";
  options.attempts = 1;
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"HTTP/1.1 401 No\r\n\r\n", "does not take this token or password (401)"},
      {"HTTP/1.1 403 No\r\n\r\n", "does not let you have that (403)"},
      {"HTTP/1.1 406 No\r\n\r\n", "is it a DICOMweb archive"},
      {"HTTP/1.1 418 very-secret\r\n\r\n", "answers 418"},
      {"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\nabc", "the connection was cut"},
      {"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n9\r\nabc", "the connection was cut"},
      {"nonsense", "the connection was cut"}};
  for (const auto& [answer, line] : wrong) {
    Answers server({answer});
    const std::string error = error_of_get(server.url(), options);
    EXPECT_THAT(error, HasSubstr(line)) << answer;
    EXPECT_THAT(error, HasSubstr(fmt::format("127.0.0.1:{}: ", server.port())));
    EXPECT_THAT(error, AllOf(Not(HasSubstr("secret")), Not(HasSubstr("\n"))));
  }
  EXPECT_THAT(error_of_get(fmt::format("http://127.0.0.1:{}", free_port()), options),
              HasSubstr("nobody answers there"));
  EXPECT_THAT(error_of_get("http://no-such-host.invalid", options),
              HasSubstr("there is no host of that name"));
  Answers open({"HTTP/1.1 401 No\r\n\r\n"});
  EXPECT_THAT(error_of_get(open.url()), HasSubstr("wants to know who asks (401)"));
  Answers large({"HTTP/1.1 200 OK\r\nContent-Length: 100\r\n\r\n" + std::string(100, 'x')});
  EXPECT_THAT(error_of([&] { HttpClient(large.url(), quick()).get("/x", "*/*", 99); }),
              HasSubstr("answers more than 99 bytes"));
}

TEST(HttpClient, DoesNotWaitForeverForOneThatIsSlow) {
  HttpOptions options = quick();
  options.attempts = 1;
  const SocketServer silent([](int socket) {
    read_head(socket);
    read_head(socket);  // until the other end has enough
  });
  const SocketServer drips([](int socket) {
    read_head(socket);
    bool sent = send_all(socket, "HTTP/1.1 200 OK\r\nContent-Length: 1000000\r\n\r\n");
    while (sent) {
      std::this_thread::sleep_for(milliseconds(20));
      sent = send_all(socket, "x");
    }
  });
  for (const SocketServer* server : {&silent, &drips}) {
    EXPECT_THAT(error_of_get(fmt::format("http://127.0.0.1:{}", server->port()), options),
                HasSubstr("does not go on within 0.3 s"));
  }
}

TEST(HttpClient, AReceiverThatThrowsEndsTheRequest) {
  Answers server({kGood});
  HttpClient client(server.url(), quick());
  EXPECT_EQ(error_of([&] {
              client.get("/x", "*/*",
                         {[](const AnswerHead& head) { EXPECT_EQ(head.content_length, 2U); },
                          [](std::string_view) { throw Error("enough"); }});
            }),
            "enough");
  EXPECT_EQ(client.get("/x", "*/*").body, "ok") << "and the next one goes on";
}

/// One authority for all, as making it takes a moment, and what speaks TLS before plain answers.
class HttpClientTls : public testing::Test {
 protected:
  HttpClientTls() : server_({kGood}) {
    options_ = quick();
    options_.attempts = 1;
    options_.authorities = authority_.certificate();
  }

  std::unique_ptr<SocketServer> gate(const TestAuthority::Issued& issued,
                                     const std::filesystem::path& clients = {}) {
    return make_tls_gate(server_.port(), issued.both, clients);
  }
  static std::string url(const std::unique_ptr<SocketServer>& gate) {
    return fmt::format("https://127.0.0.1:{}", gate->port());
  }

  TestAuthority authority_;
  Answers server_;
  HttpOptions options_;
};

TEST_F(HttpClientTls, CertificatesAreVerified) {
  const auto good = gate(authority_.issue("good"));
  EXPECT_EQ(HttpClient(url(good), options_).get("/x", "*/*").body, "ok");
  EXPECT_EQ(
      HttpClient(fmt::format("https://localhost:{}", good->port()), options_).get("/", "*/*").body,
      "ok");
  HttpOptions systems = options_;
  systems.authorities.clear();
  EXPECT_THAT(error_of_get(url(good), systems), HasSubstr("is not trusted; give"));
  HttpOptions others = options_;
  const TestAuthority other;
  others.authorities = other.certificate();
  EXPECT_THAT(error_of_get(url(good), others), HasSubstr("is not trusted"));
  others.authorities = "/dev/null";
  EXPECT_THAT(error_of_get(url(good), others), HasSubstr("/dev/null holds no certificates"));

  EXPECT_THAT(error_of_get(url(gate(authority_.issue_expired("old"))), options_),
              HasSubstr("the time of its certificate is over"));
  for (const char* hosts : {"DNS:pacs.example", "IP:127.0.0.2"}) {
    EXPECT_THAT(error_of_get(url(gate(authority_.issue("another", hosts))), options_),
                HasSubstr("its certificate is for another host"));
  }
  EXPECT_THAT(error_of_get(fmt::format("https://127.0.0.1:{}", server_.port()), options_),
              HasSubstr("speaks no TLS"));
}

TEST_F(HttpClientTls, ShowsItsOwnCertificateWhereOneIsWanted) {
  const auto strict = gate(authority_.issue("strict"), authority_.certificate());
  EXPECT_THAT(error_of_get(url(strict), options_), HasSubstr("give --client-certificate"));
  const TestAuthority::Issued mine = authority_.issue("me");
  options_.certificate = mine.certificate;
  EXPECT_THAT(error_of_get(url(strict), options_), HasSubstr("belong together"));
  options_.key = mine.key;
  EXPECT_EQ(HttpClient(url(strict), options_).get("/x", "*/*").body, "ok");
  TestAuthority stranger;
  const TestAuthority::Issued theirs = stranger.issue("them");
  options_.certificate = theirs.certificate;
  EXPECT_THAT(error_of_get(url(strict), options_), HasSubstr("is not the key of"));
  options_.key = theirs.key;
  EXPECT_THAT(error_of_get(url(strict), options_), HasSubstr("refuses the certificate of"));
}

TEST_F(HttpClientTls, ARedirectOutOfEncryptionIsRefused) {
  Answers plain({kGood});
  Answers leads({fmt::format("HTTP/1.1 302 There\r\nLocation: {}/\r\n\r\n", plain.url())});
  const auto outside = make_tls_gate(leads.port(), authority_.issue("server").both, {});
  EXPECT_THAT(error_of_get(url(outside), options_), HasSubstr("is not encrypted"));
  EXPECT_TRUE(plain.heads().empty());
}

TEST_F(HttpClientTls, AProxySeesNothingOfWhoAsks) {
  const auto archive = gate(authority_.issue("server"));
  std::string connect;
  std::string answer = "HTTP/1.1 200 Connected\r\n\r\n";
  const SocketServer proxy([&](int socket) {
    connect = read_head(socket);
    if (send_all(socket, answer) && answer.find("200") != std::string::npos) {
      const int inside = connect_to(archive->port());
      tunnel(socket, inside);
      ::close(inside);
    }
  });
  ::setenv("https_proxy", fmt::format("http://who:knocks@127.0.0.1:{}", proxy.port()).c_str(), 1);
  options_.token = "very-secret";
  EXPECT_EQ(HttpClient(url(archive), options_).get("/x", "*/*").body, "ok");
  EXPECT_THAT(connect, AllOf(HasSubstr(fmt::format("CONNECT 127.0.0.1:{} ", archive->port())),
                             HasSubstr("Proxy-Authorization: Basic d2hvOmtub2Nrcw=="),
                             Not(HasSubstr("very-secret"))));
  EXPECT_THAT(server_.heads().back(), AllOf(HasSubstr("Authorization: Bearer very-secret"),
                                            Not(HasSubstr("d2hvOmtub2Nrcw"))));
  answer = "HTTP/1.1 407 Who?\r\nContent-Length: 0\r\n\r\n";
  EXPECT_THAT(error_of_get(url(archive), options_), HasSubstr("the proxy wants to know who asks"));
  answer = "HTTP/1.1 403 No\r\nContent-Length: 0\r\n\r\n";
  EXPECT_THAT(error_of_get(url(archive), options_), HasSubstr("proxy"));
  ::setenv("https_proxy", fmt::format("http://127.0.0.1:{}", free_port()).c_str(), 1);
  EXPECT_THAT(error_of_get(url(archive), options_), HasSubstr("the proxy that leads there"));
  ::setenv("no_proxy", "127.0.0.0/8", 1);
  EXPECT_EQ(HttpClient(url(archive), options_).get("/x", "*/*").body, "ok");
  ::unsetenv("https_proxy");
  ::unsetenv("no_proxy");
}

}  // namespace
}  // namespace clipgs
