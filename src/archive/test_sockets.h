#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace clipgs::testing_support {

/// A port of the loopback that was free just now.
int free_port();

/// A connection to a port of the loopback; −1: there is none.
int connect_to(int port);

/// Whether all of it could be sent.
bool send_all(int socket, std::string_view bytes);

/// What comes up to the end of a request's head; shorter where the other end closes before.
std::string read_head(int socket);

/// Serves connections to a port of the loopback, each in a thread, until the object ends.
class SocketServer {
 public:
  /// `serve` has the connection, which is closed after it; it must end when the other end does.
  explicit SocketServer(std::function<void(int socket)> serve);
  ~SocketServer();
  SocketServer(const SocketServer&) = delete;
  SocketServer& operator=(const SocketServer&) = delete;

  int port() const { return port_; }

 private:
  void run();
  void end(int socket);

  std::function<void(int socket)> serve_;
  int listener_ = -1;
  int port_ = 0;
  std::mutex mutex_;
  std::set<int> open_;
  std::vector<std::thread> threads_;  ///< of run() alone until it has ended
  std::thread runner_;
};

/// Carries bytes both ways until one end closes, or `most` of them came from `other`.
void tunnel(int one, int other, std::uint64_t most = UINT64_MAX);

/// Stands before a server as hospitals' gateways do: TLS outside, plain HTTP inside.
/// `certificate`: PEM, with its key. `client_authorities`: only who shows a certificate of one of
/// these is let in; empty: anybody.
std::unique_ptr<SocketServer> make_tls_gate(int server, const std::filesystem::path& certificate,
                                            const std::filesystem::path& client_authorities);

}  // namespace clipgs::testing_support
