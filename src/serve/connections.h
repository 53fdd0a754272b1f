#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace clipgs {

/// What connections may take. All of it is far from what browsers do, and little to the server.
struct ConnectionLimits {
  size_t all = 512;
  size_t per_client = 256;
  /// Of a TLS handshake.
  std::chrono::milliseconds handshake{10'000};
  /// From the connection, or the end of the last answer, to the end of a request.
  std::chrono::milliseconds request{15'000};
  /// For the next 64 KiB of an answer to be taken: slow networks get through, who stops does not.
  std::chrono::milliseconds piece{30'000};
};

/// The open connections. Nobody is turned away: where there are too many, the one that is missed
/// least is closed for the new one. Of clients that is the one with the most of them, of its
/// connections one that asks for nothing, of those the one that has done so for the longest time.
class Connections {
 public:
  using Id = std::uint64_t;
  using Clock = std::chrono::steady_clock;

  explicit Connections(const ConnectionLimits& limits) : limits_(limits) {}

  /// `client`: what its connections have in common, as its address; `close` is called to close it,
  /// once at most, and need not remove it at once.
  Id add(const std::string& client, std::function<void()> close);
  void remove(Id id);
  /// Whether it is being answered: it asks for nothing until then.
  void set_answering(Id id, bool answering);
  /// Also those that come later.
  void close_all();
  /// Closes the one that is missed least, if there is any.
  void close_one();

  size_t size() const { return open_.size(); }

 private:
  struct Open {
    std::string client;
    std::function<void()> close;
    bool answering = false;
    Clock::time_point since = Clock::now();  ///< is it in this state
  };

  void close_one_of(const std::string& client);

  ConnectionLimits limits_;
  Id next_ = 0;
  bool ended_ = false;
  std::map<Id, Open> open_;
  std::map<std::string, size_t> count_;  ///< of each client
};

}  // namespace clipgs
