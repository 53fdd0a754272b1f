#include <arpa/inet.h>
#include <chrono>
#include <cstring>
#include <future>
#include <gtest/gtest.h>
#include <httplib.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include "core/file.h"
#include "serve/server.h"
#include "serve/test_cases.h"
#include "volume/test_folder.h"

namespace clipgs {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int kSlow = 200;
constexpr int kOfABrowser = 6;
/// A second, and more where other programs are busy.
constexpr auto kAtOnce = 3s;
/// Until slow ones are gone, at most.
constexpr auto kGone = 20s;
constexpr int kReceiveBuffer = 32 << 10;  // the rest of a case waits at the server
constexpr const char* kLarge = "/cases/large.sog";
constexpr size_t kLargeBytes = 5'000'000;
constexpr const char* kRequest = "GET /cases/large.sog HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";

/// A connection that does what it is told and nothing else.
class Socket {
 public:
  Socket(int port, std::string_view says, int receive_buffer = 0)
      : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    if (receive_buffer > 0) {
      ::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof(receive_buffer));
    }
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0)
        << std::strerror(errno);
    say(says);
  }
  ~Socket() { ::close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  void say(std::string_view text) const { ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL); }
  /// Up to `size` bytes, 0 at the end or after `patience`.
  size_t read(size_t size, std::chrono::milliseconds patience) const {
    pollfd one{fd_, POLLIN, 0};
    std::vector<char> bytes(size);
    if (::poll(&one, 1, static_cast<int>(patience.count())) != 1) {
      return 0;
    }
    return static_cast<size_t>(std::max<ssize_t>(0, ::recv(fd_, bytes.data(), size, 0)));
  }
  /// Whether the server has ended it by then, before it gave all of the large case.
  bool ends_before(Clock::time_point end) const {
    std::vector<char> bytes(size_t{64} << 10);
    size_t got = 0;
    for (;;) {
      pollfd one{fd_, POLLIN, 0};
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
      if (left.count() <= 0 || ::poll(&one, 1, static_cast<int>(left.count())) != 1) {
        return false;
      }
      const ssize_t n = ::recv(fd_, bytes.data(), bytes.size(), 0);
      if (n <= 0) {
        return got < kLargeBytes;
      }
      got += static_cast<size_t>(n);
    }
  }

 private:
  int fd_;
};

using Crowd = std::vector<std::unique_ptr<Socket>>;

class SlowClientsTest : public ::testing::Test {
 protected:
  void start(const ConnectionLimits& limits, bool encrypted = false) {
    test::write_large_case(folder_ / "large.sog", kLargeBytes);
    ServerOptions options{folder_.path(), "127.0.0.1", 0, {}, limits};
    if (encrypted) {
      options.identity = load_identity(folder_ / "state", {"127.0.0.1"});
      token_ = options.identity->token;
    }
    server_ = std::make_unique<Server>(options);
    thread_ = std::thread([this] { server_->run(); });
  }
  void TearDown() override {
    server_->stop();
    thread_.join();
  }

  Crowd crowd(std::string_view says, int receive_buffer = 0) const {
    Crowd result;
    for (int i = 0; i < kSlow; ++i) {
      result.push_back(std::make_unique<Socket>(server_->port(), says, receive_buffer));
    }
    return result;
  }

  /// Six requests at once, as of a browser: each is answered, and soon.
  void expect_served(const std::string& path, int status) const {
    std::vector<std::future<Clock::duration>> requests;
    for (int i = 0; i < kOfABrowser; ++i) {
      requests.push_back(std::async(std::launch::async, [&] {
        const Clock::time_point begin = Clock::now();
        EXPECT_EQ(status_of(path), status) << path;
        return Clock::now() - begin;
      }));
    }
    for (auto& request : requests) {
      EXPECT_LT(std::chrono::duration<double>(request.get()).count(),
                std::chrono::duration<double>(kAtOnce).count())
          << path;
    }
  }

  static void expect_gone(const Crowd& crowd) {
    const Clock::time_point end = Clock::now() + kGone;
    int left = 0;
    for (const auto& one : crowd) {
      left += one->ends_before(end) ? 0 : 1;
    }
    EXPECT_EQ(left, 0);
  }

  int status_of(const std::string& path) const {
    const std::string host = std::string(token_.empty() ? "http" : "https") +
                             "://127.0.0.1:" + std::to_string(server_->port());
    httplib::Client client(host);
    client.enable_server_certificate_verification(false);
    const auto response = client.Get(path);
    return response ? response->status : 0;
  }

  const TestFolder folder_;
  std::string token_;
  std::unique_ptr<Server> server_;
  std::thread thread_;
};

TEST_F(SlowClientsTest, ThoseWhoseHeadersDoNotEndHinderNobody) {
  start({.request = 2s});
  const Crowd slow = crowd("GET /api/cases HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ");
  expect_served("/api/cases", 200);
  // A letter now and then does not help them.
  for (const auto& one : slow) {
    one->say("x");
  }
  expect_served(kLarge, 200);
  expect_gone(slow);
}

TEST_F(SlowClientsTest, ThoseWhoSayNothingHinderNobody) {
  start({.request = 1s});
  const Crowd slow = crowd("");
  expect_served("/api/cases", 200);
  expect_gone(slow);
}

TEST_F(SlowClientsTest, ThoseWhoseHandshakesDoNotEndHinderNobody) {
  start({.handshake = 2s}, true);
  const Crowd slow = crowd(std::string_view("\x16\x03\x01", 3));
  expect_served("/", 403);
  expect_served('/' + token_, 302);
  expect_gone(slow);
}

TEST_F(SlowClientsTest, ThoseWhoDoNotReadHinderNobody) {
  start({.piece = 1s});
  const Crowd slow = crowd(kRequest, kReceiveBuffer);
  expect_served(kLarge, 200);
  expect_served("/api/cases", 200);
  std::this_thread::sleep_for(2s);  // they read what there is, and there is no more
  expect_gone(slow);
}

TEST_F(SlowClientsTest, ASlowNetworkGetsItsCase) {
  start({.request = 1s, .piece = 1500ms});
  const Socket headset(server_->port(), kRequest, kReceiveBuffer);
  const Clock::time_point begin = Clock::now();
  size_t bytes = 0;
  for (;;) {
    const size_t n = headset.read(size_t{64} << 10, 500ms);
    bytes += n;
    if (n == 0) {
      break;
    }
    std::this_thread::sleep_for(n * 1us / 2);  // 2 MB/s at most
  }
  EXPECT_GT(bytes, kLargeBytes);
  EXPECT_GT(Clock::now() - begin, 2s) << "longer than any of the limits";
}

TEST_F(SlowClientsTest, AboveTheLimitsNewOnesTakeTheOldOnesPlaces) {
  start({.all = 60, .per_client = 50});
  const Crowd slow = crowd("GET /");
  expect_served("/api/cases", 200);
  int left = 0;
  for (const auto& one : slow) {
    left += one->ends_before(Clock::now() + 10ms) ? 0 : 1;
  }
  EXPECT_LE(left, 50);
  EXPECT_GE(left, 50 - kOfABrowser) << "no more than necessary";
}

TEST_F(SlowClientsTest, AreNoReasonToWaitAtTheEnd) {
  start({});
  const Crowd slow = crowd("GET /");
  const Crowd readers = crowd(kRequest, kReceiveBuffer);
  const Clock::time_point begin = Clock::now();
  server_->stop();
  thread_.join();
  EXPECT_LT(Clock::now() - begin, kAtOnce);
  thread_ = std::thread([] {});
}

}  // namespace
}  // namespace clipgs
