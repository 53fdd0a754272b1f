#include "serve/server.h"

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>
#include <thread>
#include <unistd.h>

#include "core/error.h"
#include "core/file.h"
#include "serve/test_cases.h"
#include "serve/viewer_bundle.h"

namespace clipgs {
namespace {

namespace fs = std::filesystem;

using test::small_scene;

/// A folder with two good cases, a truncated one and a file that is nobody's business, and a server
/// that shows it.
class ServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("clipgs_serve_" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "cases");
    const Image thumbnail(32, 32, 3);
    Scene head = small_scene("A head");
    head.look = {"0123456789abcdef", "Bone", "Bone alone.", Modality::kCt, BodyPart::kHead};
    write_case(case_folder() / "head.sog", {head}, &thumbnail);
    write_case(case_folder() / "two words.sog", {small_scene("Two words")}, nullptr);
    const auto bytes = read_file(case_folder() / "head.sog");
    write_file(case_folder() / "broken.sog", bytes.data(), bytes.size() / 2);
    write_text(case_folder() / "notes.txt", "private");
    write_text(folder_ / "secret.sog", "private");
    fs::create_directory(case_folder() / "folder.sog");
    start();
  }

  void TearDown() override {
    server_->stop();
    thread_.join();
    fs::remove_all(folder_);
  }

  void start() {
    server_ = std::make_unique<Server>(ServerOptions{case_folder(), "127.0.0.1", 0, {}});
    thread_ = std::thread([this] { server_->run(); });
  }

  fs::path case_folder() const { return folder_ / "cases"; }
  httplib::Result get(const std::string& path, const httplib::Headers& headers = {}) {
    httplib::Client client("127.0.0.1", server_->port());
    return client.Get(path, headers);
  }

  fs::path folder_;
  std::unique_ptr<Server> server_;
  std::thread thread_;
};

TEST_F(ServerTest, ListsCasesAndBrokenFiles) {
  const auto response = get("/api/cases");
  ASSERT_TRUE(response);
  EXPECT_EQ(response->status, 200);
  const auto cases = nlohmann::json::parse(response->body).at("cases");
  ASSERT_EQ(cases.size(), 3U);
  EXPECT_EQ(cases[0].at("name"), "broken");
  EXPECT_NE(cases[0].at("error").get<std::string>().find("broken.sog"), std::string::npos);
  EXPECT_EQ(cases[0].at("error").get<std::string>().find(folder_.string()), std::string::npos);
  EXPECT_EQ(cases[1].at("title"), "A head");
  EXPECT_EQ(cases[1].at("splats"), 20);
  EXPECT_EQ(cases[1].at("bytes"), fs::file_size(case_folder() / "head.sog"));
  EXPECT_EQ(cases[1].at("look"), nlohmann::json({{"volume", "0123456789abcdef"},
                                                 {"title", "Bone"},
                                                 {"description", "Bone alone."},
                                                 {"modality", "CT"},
                                                 {"region", "head"}}));
  EXPECT_TRUE(cases[2].at("look").is_null());
  EXPECT_EQ(cases[2].at("file"), "cases/two%20words.sog");
  EXPECT_TRUE(cases[2].at("thumbnail").is_null());
}

TEST_F(ServerTest, GivesWholeCasesAndTheirThumbnails) {
  const auto index = nlohmann::json::parse(get("/api/cases")->body).at("cases");
  for (const size_t i : {size_t{1}, size_t{2}}) {
    const auto response = get("/" + index[i].at("file").get<std::string>());
    ASSERT_TRUE(response);
    EXPECT_EQ(response->status, 200);
    const auto file = read_file(case_folder() / (index[i].at("name").get<std::string>() + ".sog"));
    EXPECT_EQ(response->body, std::string(file.begin(), file.end()));
  }
  const auto thumbnail = get("/" + index[1].at("thumbnail").get<std::string>());
  EXPECT_EQ(thumbnail->status, 200);
  EXPECT_EQ(thumbnail->get_header_value("Content-Type"), "image/webp");
  EXPECT_EQ(thumbnail->body.substr(0, 4), "RIFF");
  EXPECT_EQ(get("/cases/two%20words/thumbnail")->status, 404);
}

TEST_F(ServerTest, GivesRangesOfCases) {
  const auto file = read_file(case_folder() / "head.sog");
  const std::string whole(file.begin(), file.end());
  const std::string size = std::to_string(whole.size());
  auto response = get("/cases/head.sog", {{"Range", "bytes=4-9"}});
  EXPECT_EQ(response->status, 206);
  EXPECT_EQ(response->body, whole.substr(4, 6));
  EXPECT_EQ(response->get_header_value("Content-Range"), "bytes 4-9/" + size);
  response = get("/cases/head.sog", {{"Range", "bytes=-5"}});
  EXPECT_EQ(response->body, whole.substr(whole.size() - 5));
  response = get("/cases/head.sog", {{"Range", "bytes=10-99999999"}});
  EXPECT_EQ(response->status, 206);
  EXPECT_EQ(response->body, whole.substr(10));
  response = get("/cases/head.sog", {{"Range", "bytes=99999999-"}});
  EXPECT_EQ(response->status, 416);
  EXPECT_EQ(response->get_header_value("Content-Range"), "bytes */" + size);
  response = get("/cases/head.sog", {{"Range", "bytes=0-3"}, {"If-Range", "\"older\""}});
  EXPECT_EQ(response->status, 200);
  EXPECT_EQ(response->body, whole);
  EXPECT_EQ(get("/api/cases", {{"Range", "bytes=0-99999999"}})->status, 200);
  EXPECT_EQ(get("/cases/nobody.sog", {{"Range", "bytes=900-99999999"}})->status, 404);
}

TEST_F(ServerTest, ChangedCasesAreNoticed) {
  auto response = get("/cases/head.sog");
  const std::string etag = response->get_header_value("ETag");
  ASSERT_FALSE(etag.empty());
  response = get("/cases/head.sog", {{"If-None-Match", etag}});
  EXPECT_EQ(response->status, 304);
  EXPECT_TRUE(response->body.empty());
  write_case(case_folder() / "head.sog", {small_scene("Another head")}, nullptr);
  response = get("/cases/head.sog", {{"If-None-Match", etag}});
  EXPECT_EQ(response->status, 200);
  EXPECT_NE(response->get_header_value("ETag"), etag);
  const auto index = nlohmann::json::parse(get("/api/cases")->body).at("cases");
  EXPECT_EQ(index[1].at("title"), "Another head");
}

TEST_F(ServerTest, GivesNothingElse) {
  for (const char* path :
       {"/cases/../secret.sog", "/cases/..%2Fsecret.sog", "/cases/%2e%2e/secret.sog",
        "/cases/%2e%2e%2fsecret.sog", "/cases/..%5csecret.sog", "/../secret.sog",
        "/cases/notes.txt", "/cases/notes.sog", "/cases/folder.sog", "/cases/", "/cases/.sog",
        "/cases", "/notes.txt", "//etc/passwd", "/cases//etc/passwd.sog", "/cases/head.sog/",
        "/thumbnail", "/cases/%00.sog", "/assets/../../cases/notes.txt"}) {
    const auto response = get(path);
    ASSERT_TRUE(response) << path;
    EXPECT_EQ(response->status, 404) << path;
    EXPECT_EQ(response->body.find("private"), std::string::npos) << path;
  }
}

TEST_F(ServerTest, SaysWhyABrokenCaseCannotBeShown) {
  const auto response = get("/cases/broken.sog");
  EXPECT_EQ(response->status, 422);
  EXPECT_NE(response->body.find("broken.sog"), std::string::npos);
  EXPECT_EQ(std::count(response->body.begin(), response->body.end(), '\n'), 1);
  EXPECT_EQ(get("/cases/broken/thumbnail")->status, 422);
}

TEST_F(ServerTest, IsolatesThePageAndRefusesOtherNames) {
  const auto response = get("/api/cases");
  EXPECT_EQ(response->get_header_value("Cross-Origin-Opener-Policy"), "same-origin");
  EXPECT_EQ(response->get_header_value("Cross-Origin-Embedder-Policy"), "require-corp");
  EXPECT_EQ(response->get_header_value("X-Content-Type-Options"), "nosniff");
  EXPECT_EQ(get("/api/cases", {{"Host", "evil.example"}})->status, 403);
  EXPECT_EQ(get("/api/cases", {{"Host", "localhost"}})->status, 200);
  httplib::Client client("127.0.0.1", server_->port());
  EXPECT_EQ(client.Post("/api/cases", "x", "text/plain")->status, 405);
}

TEST_F(ServerTest, GivesTheViewer) {
  const auto page = get("/");
  ASSERT_TRUE(page);
  if (viewer_files().empty()) {
    EXPECT_EQ(page->status, 404);
    GTEST_SKIP() << "built without the viewer";
  }
  EXPECT_EQ(page->status, 200);
  EXPECT_EQ(page->get_header_value("Content-Type"), "text/html; charset=utf-8");
  for (const ViewerFile& file : viewer_files()) {
    for (const char* encodings : {"identity", "gzip", "br"}) {  // undone by the client
      const auto response = get("/" + std::string(file.path), {{"Accept-Encoding", encodings}});
      EXPECT_EQ(response->status, 200) << file.path << " " << encodings;
      EXPECT_EQ(response->body, file.bytes) << file.path << " " << encodings;
    }
  }
}

TEST_F(ServerTest, EncryptsAndAnswersThoseAloneWhoKnowTheToken) {
  const ServerIdentity identity = load_identity(folder_ / "state", {"127.0.0.1"});
  Server server({case_folder(), "127.0.0.1", 0, identity});
  EXPECT_EQ(server.url(),
            "https://127.0.0.1:" + std::to_string(server.port()) + "/" + identity.token);
  std::thread thread([&] { server.run(); });
  write_text(folder_ / "authority.pem", identity.certificate.certificate);
  httplib::SSLClient client("127.0.0.1", server.port());
  client.set_ca_cert_path((folder_ / "authority.pem").c_str());
  client.enable_server_certificate_verification(true);
  for (const char* path :
       {"/", "/api/cases", "/cases/head.sog", "/k3v9q-txw7h-23456-abcde-fghijk", "/assets"}) {
    const auto refused = client.Get(path);
    ASSERT_TRUE(refused) << path << " " << httplib::to_string(refused.error());
    EXPECT_EQ(refused->status, 403) << path;
  }
  const auto entered = client.Get("/" + identity.token);
  ASSERT_TRUE(entered);
  EXPECT_EQ(entered->status, 302);
  EXPECT_EQ(entered->get_header_value("Location"), "/");
  const std::string cookie = entered->get_header_value("Set-Cookie");
  EXPECT_NE(cookie.find("; Secure; HttpOnly; SameSite=Lax"), std::string::npos);
  const std::string pair = cookie.substr(0, cookie.find(';'));
  EXPECT_EQ(client.Get("/api/cases", {{"Cookie", "other=1; " + pair}})->status, 200);
  EXPECT_EQ(client.Get("/cases/head.sog", {{"Cookie", pair}})->status, 200);
  EXPECT_EQ(client.Get("/api/cases", {{"Cookie", pair + "x"}})->status, 403);
  httplib::Client plain("127.0.0.1", server.port());
  EXPECT_FALSE(plain.Get("/api/cases"));
  server.stop();
  thread.join();
}

TEST_F(ServerTest, APortThatIsTakenIsAnError) {
  try {
    const Server second({case_folder(), "127.0.0.1", server_->port(), {}});
    FAIL() << "two servers on one port";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("taken"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("--port"), std::string::npos);
  }
}

TEST_F(ServerTest, TheFolderMustBeThere) {
  EXPECT_THROW(Server({folder_ / "nowhere", "127.0.0.1", 0, {}}), Error);
  EXPECT_THROW(Server({case_folder() / "head.sog", "127.0.0.1", 0, {}}), Error);
}

TEST_F(ServerTest, AnEmptyFolderIsServed) {
  fs::create_directory(folder_ / "empty");
  const Server server({folder_ / "empty", "127.0.0.1", 0, {}});
  EXPECT_EQ(server.case_count(), 0U);
}

TEST_F(ServerTest, StopsBeforeItRuns) {
  Server server({case_folder(), "127.0.0.1", 0, {}});
  server.stop();
  server.run();
}

}  // namespace
}  // namespace clipgs
