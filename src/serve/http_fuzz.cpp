// libFuzzer's entry to what answers HTTP requests: after a byte that says who is asked comes what a
// client sends.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/file.h"
#include "core/fuzz.h"
#include "serve/access_log.h"
#include "serve/client.h"
#include "serve/site.h"
#include "serve/test_cases.h"
#include "serve/token.h"

namespace clipgs::fuzz {

namespace {

constexpr const char* kToken = "k3v9q-txw7h-23456-abcde-fghijk";
/// The byte before a request to a site that everyone may ask, to one on a loopback address, and to
/// one that wants the token.
constexpr char kOpen = 0;
constexpr char kLocal = 1;
constexpr char kSecret = 2;

/// A folder with a case and a link out of it, to what nobody may have.
std::filesystem::path make_folder() {
  const std::filesystem::path folder = scratch_folder() / "cases";
  std::filesystem::create_directories(folder);
  clipgs::test::write_small_case(folder / "head.sog", "A head");
  write_text(scratch_folder() / "secret.sog", "nobody may have this");
  std::filesystem::create_symlink("../secret.sog", folder / "link.sog");
  return folder;
}

/// Whatever a request says, its line in a log is one, and of ASCII.
void log_request(const std::string& text) {
  static const TrustedProxies kProxies({"127.0.0.0/8"});
  RequestParser parser;
  boost::system::error_code error;
  parser.put(boost::asio::buffer(text), error);
  const HttpRequest& request = parser.get();
  const Client client = kProxies.client(boost::asio::ip::make_address("127.0.0.1"), request);
  const std::string line =
      access_line({request, Site::refuse(error), client}, std::chrono::system_clock::now());
  if (!std::ranges::all_of(line, [](char c) { return c >= ' ' && c <= '~'; })) {
    std::abort();
  }
}

/// Whoever types it may leave out strokes, add some and write capitals.
bool has_token(std::string_view request) {
  static const std::string kPlain = plain_token(kToken);
  return plain_token(request).find(kPlain) != std::string::npos;
}

}  // namespace

std::vector<Bytes> seeds() {
  const std::string end = " HTTP/1.1\r\nHost: localhost:8080\r\n";
  const std::vector<std::string> requests = {
      kOpen + ("GET /" + end + "Accept-Encoding: gzip;q=0.5, br, *;q=0\r\n\r\n"),
      kOpen + ("GET /cases/link.sog" + end + "\r\n"),
      kOpen + ("GET /cases/..%2Fsecret.sog" + end + "\r\n"),
      kOpen + ("POST /api/cases" + end + "Content-Length: 3\r\n\r\nabc"),
      kLocal + ("POST /api/study/sessions/p007-3f9c2a1b" + end +
                "Content-Type: application/jsonl\r\nContent-Length: 29\r\n\r\n"
                "{\"seq\":1,\"kind\":\"comment\"}\r\n"),
      kLocal + ("GET /study/clipgs-vr.json" + end + "\r\n"),
      kLocal + ("GET /api/study/sessions?participant=7" + end + "\r\n"),
      kLocal + ("GET /cases/head.sog" + end + "Range: bytes=4-9,-5\r\nIf-Range: \"1\"\r\n\r\n"),
      kLocal + ("HEAD /cases/head/thumbnail?v=1" + end + "If-None-Match: W/\"a\", *\r\n\r\n"),
      kLocal + std::string("GET /api/cases HTTP/1.0\r\nHost: [::ffff:127.0.0.1]:80\r\n\r\n"),
      kSecret + (std::string("GET /") + kToken + end + "\r\n"),
      kLocal + ("GET /metrics" + end + "X-Forwarded-For: 6.6.6.6, [2001:db8::7]:1\r\n" +
                "Forwarded: for=\"[::1]:2\";by=x\r\nUser-Agent: \xff\"\r\n\r\n"),
      kSecret + ("GET /health" + end + "Authorization: Bearer " + kToken + "\r\n\r\n"),
      kSecret +
          ("GET /api/cases" + end + "Authorization: bearer K3V9QTXW7H-23456-abcde-fghij-k\r\n\r\n"),
      kSecret + ("GET /api/cases" + end + "Cookie: a=1; __Host-clipgs=" + kToken + "\r\n\r\n"),
  };
  std::vector<Bytes> result;
  for (const std::string& request : requests) {
    result.push_back(bytes_of(request));
  }
  return result;
}

void read(std::span<const std::uint8_t> input) {
  static const std::filesystem::path kFolder = make_folder();
  static Site sites[] = {
      Site({kFolder, "", {}, "http://127.0.0.1/"}),
      Site({kFolder, "", "localhost", "http://127.0.0.1/", scratch_folder() / "study"}),
      Site({kFolder, kToken, {}, "https://127.0.0.1/"}),
  };
  if (input.empty()) {
    return;
  }
  const size_t who = input.front() % std::size(sites);
  const std::string request = text_of(input.subspan(1));
  const std::string answer = sites[who].answer_bytes(request);
  log_request(request);
  // That it is well, "ok\n", is for everybody.
  const bool is_health = answer.find("\r\nContent-Length: 3\r\n") != std::string::npos;
  const bool entered =
      who == kSecret && answer.starts_with("HTTP/1.1 200") && !is_health && !has_token(request);
  if (entered || answer.find("nobody may have this") != std::string::npos) {
    std::abort();
  }
}

}  // namespace clipgs::fuzz
