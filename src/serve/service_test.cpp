// What a hospital watches, logs and lets in, over real sockets.

#include <cstdlib>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include "core/file.h"
#include "serve/access_tokens.h"
#include "serve/server.h"
#include "serve/test_cases.h"
#include "serve/token.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;

constexpr const char* kWard = "warda-aaaaa-aaaaa-aaaaa-aaaaaa";
constexpr const char* kChief = "chief-aaaaa-aaaaa-aaaaa-aaaaaa";
constexpr const char* kWatch = "watch-aaaaa-aaaaa-aaaaa-aaaaaa";
constexpr const char* kLate = "laate-aaaaa-aaaaa-aaaaa-aaaaaa";

std::string marks_file() { return R"({"clipgs_marks":1,"volume":"","marks":[]})"; }

/// The lines of a log, once there are so many.
std::vector<nlohmann::json> lines_of(const fs::path& file, size_t count) {
  std::vector<nlohmann::json> lines;
  for (int i = 0; i < 500 && lines.size() < count; ++i) {
    lines.clear();
    std::istringstream text(fs::exists(file) ? read_text(file) : "");
    for (std::string line; std::getline(text, line);) {
      lines.push_back(nlohmann::json::parse(line));
    }
    if (lines.size() < count) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  EXPECT_EQ(lines.size(), count) << file;
  return lines;
}

/// Of all labels together.
double total_of(const std::map<std::string, double>& samples, const std::string& name) {
  double total = 0;
  for (const auto& [sample, value] : samples) {
    total += sample.starts_with(name + "{") ? value : 0;
  }
  return total;
}

class ServiceTest : public ::testing::Test {
 protected:
  ServiceTest() {
    options_.folder = folder_ / "cases";
    options_.port = 0;
    fs::create_directories(options_.folder / "cardiology" / "2027");
    test::write_small_case(options_.folder / "head.sog", "A head");
    test::write_small_case(options_.folder / "cardiology" / "heart.sog", "A heart");
    test::write_small_case(options_.folder / "cardiology" / "2027" / "of two words.sog", "Two");
  }
  ~ServiceTest() override {
    if (server_) {
      server_->stop();
      thread_.join();
    }
  }

  void use_tokens() {
    options_.tokens = folder_ / "tokens.json";
    write_tokens(options_.tokens,
                 {{{"ward", {"cardiology"}, false, false}, token_digest(kWard), ""},
                  {{"chief", {"."}, true, false}, token_digest(kChief), "2999-12-31"},
                  {{"watch", {}, false, true}, token_digest(kWatch), ""},
                  {{"late", {"."}, true, true}, token_digest(kLate), "2020-01-31"}});
  }
  void start() {
    server_ = std::make_unique<Server>(options_);
    thread_ = std::thread([this] { server_->run(); });
  }

  /// `token`: brought as programs do; "": none.
  httplib::Result get(const std::string& path, const std::string& token = "",
                      httplib::Headers headers = {}) {
    if (!token.empty()) {
      headers.emplace("Authorization", "Bearer " + token);
    }
    httplib::Client client("127.0.0.1", server_->port());
    return client.Get(path, headers);
  }
  int status(const std::string& path, const std::string& token = "",
             const httplib::Headers& headers = {}) {
    const auto response = get(path, token, headers);
    return response ? response->status : 0;
  }

  const TestFolder folder_;
  ServerOptions options_;
  std::unique_ptr<Server> server_;
  std::thread thread_;
};

/// What a text in Prometheus' format says, by name and labels; fails where it is none.
std::map<std::string, double> samples_of(const std::string& text) {
  const std::string name = "[a-zA-Z_:][a-zA-Z0-9_:]*";
  const std::string label = R"re([a-zA-Z_][a-zA-Z0-9_]*="([^"\\]|\\[\\"n])*")re";
  const std::string sample = name + R"((\{)" + label + "(," + label + R"()*\})? [0-9.e+-]+)";
  std::map<std::string, double> samples;
  std::string family;
  EXPECT_TRUE(text.ends_with('\n'));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) {
      EXPECT_THAT(line, MatchesRegex("# TYPE " + name + " (counter|gauge)"));
      family = line.substr(7, line.rfind(' ') - 7);
      EXPECT_EQ(line.ends_with(" counter"), family.ends_with("_total")) << line;
    } else if (!line.starts_with("# HELP ")) {
      EXPECT_THAT(line, MatchesRegex(sample));
      const std::string key = line.substr(0, line.rfind(' '));
      EXPECT_EQ(key.substr(0, key.find('{')), family) << "its family stands before it";
      EXPECT_TRUE(samples.emplace(key, std::stod(line.substr(key.size()))).second) << line;
    }
  }
  return samples;
}

TEST_F(ServiceTest, SaysThatItIsWellToEverybodyAndNothingElse) {
  use_tokens();
  start();
  const auto well = get("/health", "", {{"Host", "balancer.example"}});
  ASSERT_TRUE(well);
  EXPECT_EQ(well->status, 200);
  EXPECT_EQ(well->body, "ok\n");
  fs::rename(options_.folder, folder_ / "away");
  const auto ill = get("/health");
  EXPECT_EQ(ill->status, 503);
  EXPECT_THAT(ill->body, AllOf(HasSubstr("the folder of the cases cannot be read"),
                               Not(HasSubstr(folder_.path().string()))));
  EXPECT_EQ(std::ranges::count(ill->body, '\n'), 1);
  EXPECT_EQ(samples_of(get("/metrics", kWatch)->body).at("clipgs_folder_readable"), 0);
  fs::rename(folder_ / "away", options_.folder);
  EXPECT_EQ(status("/health"), 200);
}

TEST_F(ServiceTest, CountsWhatItDoes) {
  write_text(options_.folder / "broken.sog", "no case");
  options_.subfolders = true;
  start();
  EXPECT_EQ(status("/cases/head.sog"), 200);
  EXPECT_EQ(status("/cases/head.sog", "", {{"Range", "bytes=0-9"}}), 206);
  EXPECT_EQ(status("/cases/nobody.sog"), 404);
  EXPECT_EQ(status("/api/cases"), 200);
  EXPECT_EQ(status("/k3v9q"), 404);
  // What is sent is counted after that, perhaps after it is read.
  auto response = get("/metrics");
  std::map<std::string, double> samples = samples_of(response->body);
  for (int i = 0; i < 500 && total_of(samples, "clipgs_http_requests_total") < 5; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    response = get("/metrics");
    samples = samples_of(response->body);
    samples.erase(R"(clipgs_http_requests_total{kind="metrics",code="200"})");
  }
  EXPECT_EQ(response->get_header_value("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_EQ(samples[R"(clipgs_http_requests_total{kind="case",code="200"})"], 1);
  EXPECT_EQ(samples[R"(clipgs_http_requests_total{kind="case",code="206"})"], 1);
  EXPECT_EQ(samples[R"(clipgs_http_requests_total{kind="case",code="404"})"], 1);
  EXPECT_EQ(samples[R"(clipgs_http_requests_total{kind="index",code="200"})"], 1);
  EXPECT_EQ(samples[R"(clipgs_http_requests_total{kind="other",code="404"})"], 1);
  EXPECT_GT(samples[R"(clipgs_http_sent_bytes_total{kind="case"})"],
            static_cast<double>(fs::file_size(options_.folder / "head.sog")));
  EXPECT_EQ(samples["clipgs_cases_opened_total"], 1);
  EXPECT_EQ(samples[R"(clipgs_cases{state="shown"})"], 3);
  EXPECT_EQ(samples[R"(clipgs_cases{state="broken"})"], 1);
  EXPECT_GE(samples["clipgs_connections"], 1);
  EXPECT_GT(samples["clipgs_uptime_seconds"], 0);
  EXPECT_GT(samples["process_resident_memory_bytes"], 1e6);
  EXPECT_EQ(samples.count("clipgs_folder_readable"), 1U);
  EXPECT_THAT(response->body, HasSubstr("\nclipgs_build_info{version=\"0."));
}

TEST_F(ServiceTest, MetricsAreForThisMachineOrATokenThatMayReadThem) {
  start();
  EXPECT_EQ(status("/metrics"), 200);
  EXPECT_EQ(status("/metrics", "", {{"X-Forwarded-For", "127.0.0.1"}}), 403) << "a proxy asks";
  server_->stop();
  thread_.join();
  use_tokens();
  start();
  EXPECT_EQ(status("/metrics"), 403);
  EXPECT_EQ(status("/metrics", kChief), 403);
  EXPECT_EQ(status("/metrics", kWatch), 200);
  EXPECT_EQ(status("/cases/head.sog", kWatch), 404) << "and no case";
  EXPECT_THAT(nlohmann::json::parse(get("/api/cases", kWatch)->body).at("cases"), IsEmpty());
}

TEST(Metrics, LabelsAreEscaped) { EXPECT_EQ(metric_label("a\\b\"c\nd"), "a\\\\b\\\"c\\nd"); }

TEST_F(ServiceTest, GivesEachWhatItMaySee) {
  use_tokens();
  options_.keeps = {true, true};
  options_.audit = folder_ / "audit.jsonl";
  start();
  const auto names = [&](const std::string& token) {
    std::vector<std::string> result;
    const auto index = nlohmann::json::parse(get("/api/cases", token)->body);
    for (const auto& one : index.at("cases")) {
      result.push_back(one.at("name"));
    }
    return result;
  };
  EXPECT_THAT(names(kWard), ElementsAre("cardiology/2027/of two words", "cardiology/heart"));
  EXPECT_THAT(names(kChief),
              ElementsAre("cardiology/2027/of two words", "cardiology/heart", "head"));
  const auto index = nlohmann::json::parse(get("/api/cases", kWard)->body);
  EXPECT_FALSE(index.at("keeps_marks") || index.at("keeps_tours"));
  const auto& nested = index.at("cases")[0];
  EXPECT_EQ(nested.at("file"), "cases/cardiology/2027/of%20two%20words.sog");
  EXPECT_EQ(status("/" + nested.at("file").get<std::string>(), kWard), 200);
  EXPECT_EQ(status("/" + nested.at("thumbnail").get<std::string>(), kWard), 200);
  EXPECT_EQ(status("/cases/cardiology%2Fheart.sog", kWard), 200);
  for (const char* path : {"/cases/head.sog", "/cases/head/thumbnail", "/cases/head.marks.json",
                           "/cases/cardiology/../head.sog", "/cases/cardiology/%2e%2e/head.sog",
                           "/cases/cardiology//heart.sog", "/cases//cardiology/heart.sog"}) {
    EXPECT_EQ(status(path, kWard), 404) << path;
  }
  EXPECT_EQ(status("/cases/head.sog", kChief), 200);
  const auto put = [&](const std::string& name, const std::string& token) {
    httplib::Client client("127.0.0.1", server_->port());
    const auto response = client.Put("/cases/" + name + ".marks.json",
                                     {{"If-None-Match", "*"}, {"Authorization", "Bearer " + token}},
                                     marks_file(), "application/json");
    return response ? response->status : 0;
  };
  EXPECT_EQ(put("cardiology/heart", kWard), 403) << "it looks alone";
  EXPECT_FALSE(fs::exists(options_.folder / "cardiology" / "heart.marks.json"));
  EXPECT_EQ(put("cardiology/heart", kChief), 204);
  EXPECT_EQ(read_text(options_.folder / "cardiology" / "heart.marks.json"), marks_file());
  EXPECT_EQ(status("/cases/cardiology/heart.marks.json", kWard), 200);
  EXPECT_EQ(put("cardiology/../head", kChief), 404);
  EXPECT_EQ(put("cardiology/heart", kChief), 412) << "somebody was faster";
  const nlohmann::json change = lines_of(options_.audit, 4).back();  // behind three openings
  EXPECT_EQ(change.at("event"), "changed");
  EXPECT_EQ(change.at("what"), "marks");
  EXPECT_EQ(change.at("token"), "chief");
  EXPECT_EQ(change.at("case"), "cardiology/heart");
}

TEST_F(ServiceTest, GivesTheOverviewToWhoSeesAllCases) {
  use_tokens();
  fs::create_directories(options_.folder / "overview");
  write_text(options_.folder / "overview" / "index.html", "<!doctype html><title>All</title>");
  start();
  EXPECT_EQ(status("/overview/", kChief), 200);
  EXPECT_EQ(status("/overview/", kWard), 403);
  EXPECT_EQ(status("/overview/index.html", kWard), 403);
}

TEST_F(ServiceTest, LetsInByAddressCookieOrHeaderUntilATokenIsOver) {
  use_tokens();
  start();
  const auto entered = get("/WARDA-AAAAA-aaaaaaaaaaaaaaaa?x=1");
  ASSERT_EQ(entered->status, 302);
  EXPECT_EQ(entered->get_header_value("Location"), "/?x=1");
  const std::string cookie = entered->get_header_value("Set-Cookie");
  EXPECT_THAT(cookie, AllOf(HasSubstr(std::string("__Host-clipgs=") + kWard + ";"),
                            HasSubstr("; Secure; HttpOnly; SameSite=Lax")));
  const std::string pair = cookie.substr(0, cookie.find(';'));
  EXPECT_EQ(status("/api/cases", "", {{"Cookie", pair}}), 200);
  EXPECT_EQ(status("/api/cases"), 403);
  EXPECT_EQ(status("/api/cases", "wrong"), 403);
  EXPECT_EQ(status(std::string("/") + kLate), 403);
  EXPECT_THAT(get("/api/cases", kLate)->body, HasSubstr("is over"));
  write_tokens(options_.tokens, {});
  EXPECT_EQ(status("/api/cases", "", {{"Cookie", pair}}), 403) << "removed meanwhile";
  int refused = 0;
  for (int i = 0; i < 12 && refused != 429; ++i) {
    refused = status("/api/cases", "wrong");
  }
  EXPECT_EQ(refused, 429);
}

TEST_F(ServiceTest, LogsWhatIsAskedWithoutSecrets) {
  use_tokens();
  options_.access_log = folder_ / "access.jsonl";
  options_.study = folder_ / "study";
  options_.proxies = {"127.0.0.1"};
  start();
  EXPECT_EQ(status(std::string("/") + kWard + "?secret-query"), 302);
  EXPECT_EQ(status("/wardb-aaaaa-aaaaa-aaaaa-aaaaaa/"), 403);
  EXPECT_EQ(status("/cases/cardiology/heart.sog?v=secret-query", kWard,
                   {{"X-Forwarded-For", "6.6.6.6, 192.0.2.7"},
                    {"Cookie", "secret-cookie=1"},
                    {"Referer", "https://secret-referer/"},
                    {"User-Agent", "a \"browser\"\t\xff{}"}}),
            200);
  EXPECT_EQ(status("/cases/%0A%22%7D%0D%0Aforged%E2%80%A8.sog", kChief), 404);
  httplib::Client client("127.0.0.1", server_->port());
  client.Post("/api/study/sessions/p007-3f9c2a1b",
              {{"Authorization", std::string("Bearer ") + kChief}},
              R"({"seq":1,"kind":"comment","text":"secret-comment"})", "application/jsonl");
  EXPECT_EQ(status("/%zz-secret-address"), 400);
  EXPECT_EQ(status("*"), 400);
  const auto lines = lines_of(options_.access_log, 7);
  const std::string text = read_text(options_.access_log);
  for (const char* secret : {kWard, kChief, "wardb", "secret-", "aaaaa-aaaaa", "Bearer", "p007"}) {
    EXPECT_THAT(text, Not(HasSubstr(secret)));
  }
  EXPECT_EQ(
      text.find_first_not_of("\n !\"#$%&'()*+,-./0123456789:;<=>?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]"
                             "^_`abcdefghijklmnopqrstuvwxyz{|}~"),
      std::string::npos);
  EXPECT_EQ(lines[0].at("token"), "ward");
  EXPECT_EQ(lines[0].at("status"), 302);
  EXPECT_EQ(lines[0].at("path"), "");
  EXPECT_EQ(lines[2].at("client"), "192.0.2.7");
  EXPECT_EQ(lines[2].at("path"), "/cases/cardiology/heart.sog");
  EXPECT_EQ(lines[2].at("kind"), "case");
  EXPECT_EQ(lines[2].at("method"), "GET");
  EXPECT_GT(lines[2].at("bytes"), fs::file_size(options_.folder / "cardiology" / "heart.sog"));
  EXPECT_EQ(lines[2].at("agent"), "a \"browser\"\t\uFFFD{}");
  EXPECT_EQ(lines[3].at("path"), "/cases/\n\"}\r\nforged\u2028.sog");
  EXPECT_EQ(lines[4].at("kind"), "study");
  struct stat state{};
  ASSERT_EQ(::stat(options_.access_log.c_str(), &state), 0);
  EXPECT_EQ(state.st_mode & 07U, 0U);
  fs::rename(options_.access_log, folder_ / "access.1");
  server_->reopen_logs();
  EXPECT_EQ(status("/health"), 200);
  EXPECT_EQ(lines_of(options_.access_log, 1)[0].at("path"), "/health");
  EXPECT_EQ(lines_of(folder_ / "access.1", 7).size(), 7U);
}

TEST_F(ServiceTest, RecordsWhoOpensACaseOnce) {
  use_tokens();
  options_.audit = folder_ / "audit.jsonl";
  options_.proxies = {"127.0.0.1"};
  start();
  const std::string heart = "/cases/cardiology/heart.sog";
  const httplib::Headers other = {{"X-Forwarded-For", "192.0.2.8"}};
  EXPECT_EQ(status("/cases/cardiology/heart/thumbnail", kWard), 200) << "of the list";
  EXPECT_EQ(status("/cases/head.sog", kWard), 404) << "not given";
  EXPECT_EQ(status(heart), 403) << "not given";
  EXPECT_TRUE(read_text(options_.audit).empty());
  const std::string etag = get(heart, kWard)->get_header_value("ETag");
  for (const char* range : {"bytes=0-3", "bytes=4-", "bytes=-9"}) {
    EXPECT_EQ(status(heart, kWard, {{"Range", range}}), 206);
  }
  EXPECT_EQ(status(heart, kWard, other), 200);
  EXPECT_EQ(status(heart, kChief, {{"If-None-Match", etag}}), 304)
      << "it is in the browser, and seen";
  const auto lines = lines_of(options_.audit, 3);
  EXPECT_EQ(lines[0].at("token"), "ward");
  EXPECT_EQ(lines[0].at("client"), "127.0.0.1");
  EXPECT_EQ(lines[0].at("case"), "cardiology/heart");
  EXPECT_EQ('"' + lines[0].at("version").get<std::string>() + '"', etag);
  EXPECT_THAT(lines[0].at("time").get<std::string>(),
              MatchesRegex("20[0-9]{2}-[0-9]{2}-[0-9]{2}T[0-9:]{8}\\.[0-9]{3}Z"));
  EXPECT_EQ(lines[1].at("client"), "192.0.2.8");
  EXPECT_EQ(lines[2].at("token"), "chief");
  fs::remove(options_.audit);
  EXPECT_EQ(status("/cases/head.sog", kChief), 200);
  EXPECT_EQ(lines_of(options_.audit, 1)[0].at("case"), "head") << "made anew";
}

TEST_F(ServiceTest, GivesNoCaseThatItCannotRecord) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "there is no /dev/full";
  }
  const fs::path audit = folder_ / "audit.jsonl";
  fs::create_symlink("/dev/full", audit);
  options_.audit = audit;
  start();
  const auto refused = get("/cases/head.sog");
  EXPECT_EQ(refused->status, 503);
  EXPECT_EQ(std::ranges::count(refused->body, '\n'), 1);
  EXPECT_THAT(refused->body, AllOf(HasSubstr("recorded"), Not(HasSubstr("audit.jsonl"))));
  EXPECT_EQ(status("/cases/head.sog"), 503) << "again";
  EXPECT_EQ(status("/health"), 503);
  EXPECT_EQ(status("/cases/head/thumbnail"), 200);
  EXPECT_EQ(samples_of(get("/metrics")->body).at("clipgs_cases_opened_total"), 0);
  fs::remove(audit);
  server_->reopen_logs();
  EXPECT_EQ(status("/health"), 200) << "before anybody is sent here again";
  EXPECT_EQ(status("/health"), 200);
  EXPECT_EQ(status("/cases/head.sog"), 200);
  const auto lines = lines_of(audit, 2);
  EXPECT_EQ(lines[0].at("event"), "resumed");
  EXPECT_EQ(lines[1].at("case"), "head");
}

TEST(CaseOpenings, AreNewAfterARest) {
  CaseOpenings openings("");
  const Client client{"192.0.2.7", "192.0.2.7"};
  CaseEntry entry;
  entry.name = "head";
  const auto now = CaseOpenings::Clock::now();
  using std::chrono::minutes;
  for (const int minute : {0, 14, 28, 42}) {
    openings.note(client, "ward", entry, now + minutes(minute));
  }
  EXPECT_EQ(openings.count(), 1U) << "it goes on";
  openings.note(client, "ward", entry, now + minutes(58));
  EXPECT_EQ(openings.count(), 2U);
  entry.version = "2";
  openings.note(client, "ward", entry, now + minutes(58));
  EXPECT_EQ(openings.count(), 3U) << "another case of that name";
}

TEST_F(ServiceTest, IsCalledByItsPublicName) {
  options_.public_url = "https://cases.hospital.example/";
  start();
  EXPECT_EQ(server_->url(), "https://cases.hospital.example/");
  EXPECT_EQ(status("/api/cases", "", {{"Host", "cases.hospital.example"}}), 200);
  EXPECT_EQ(status("/api/cases", "", {{"Host", "hospital.example"}}), 403);
  for (const char* wrong : {"cases", "https://", "ftp://a/", "https://a", "https://a/b/"}) {
    ServerOptions options = options_;
    options.public_url = wrong;
    EXPECT_THAT(error_of([&] { Server server(options); }), HasSubstr("no address to open"))
        << wrong;
  }
}

TEST_F(ServiceTest, ShowsAnAuthoritysCertificate) {
  const Certificate own = make_certificate({"127.0.0.1"});
  write_text(folder_ / "chain.pem", own.certificate + make_certificate({"other"}).certificate);
  write_text(folder_ / "key.pem", own.key);
  const auto load = [&] { return load_certificate(folder_ / "chain.pem", folder_ / "key.pem"); };
  EXPECT_THAT(error_of(load), HasSubstr("chmod o= "));
  ::chmod((folder_ / "key.pem").c_str(), 0640);
  options_.identity = ServerIdentity{load(), ""};
  start();
  write_text(folder_ / "authority.pem", own.certificate);
  httplib::SSLClient client("127.0.0.1", server_->port());
  client.set_ca_cert_path((folder_ / "authority.pem").c_str());
  client.enable_server_certificate_verification(true);
  const auto response = client.Get("/api/cases");
  ASSERT_TRUE(response) << httplib::to_string(response.error());
  EXPECT_EQ(response->status, 200) << "who is let in is another matter";
  write_text(folder_ / "key.pem", make_certificate({"127.0.0.1"}).key);
  ::chmod((folder_ / "key.pem").c_str(), 0600);
  EXPECT_THAT(error_of(load), HasSubstr("is not the key of"));
  write_text(folder_ / "chain.pem", "nothing");
  EXPECT_THAT(error_of(load), HasSubstr("holds no certificate"));
}

}  // namespace
}  // namespace clipgs
